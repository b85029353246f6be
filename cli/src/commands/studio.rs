use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::Args;
use htex_base::files::{Key, OwnFolder};
use htex_lab::page::ServedFolder;

use crate::failure::{Exit, Failure, Result};
use crate::output::{print, warn};
use crate::shared;
use crate::signals;

/// The port of the page, unless another one is given. It is fixed, so that the browser finds the
/// user's textures again.
const PORT: u16 = 8420;
/// How often to check whether the command should end.
const NOTICED: Duration = Duration::from_millis(100);
/// The part of a build that a server serves.
const STATIC: &str = "static";
/// Name of the key file in the user's configuration folder.
const KEY: &str = "studio.key";

/// Touch and shape textures in the browser
///
/// The studio is a web page. htex serves the page on this machine only, until you press Ctrl-C. The
/// command prints the address of the page, `http://NAME.localhost:8420/`. NAME depends on the
/// folder of the page and on a secret key that htex stores for you. Therefore, other users of the
/// machine cannot guess the address. Chromium, Edge and Firefox resolve this address without
/// further settings. For another browser, such as Safari, add the line `127.0.0.1 NAME.localhost`
/// to /etc/hosts.
///
/// `cargo xtask studio --out DIR` builds the page. The page sends requests only to its own address.
#[derive(Args)]
pub(crate) struct Studio {
    /// Folder of the page, as written by `cargo xtask studio` [default: $HTEX_STUDIO, or
    /// ../share/htex/studio relative to the command]
    #[arg(long, value_name = "DIR")]
    folder: Option<PathBuf>,

    /// Port of the address. The browser stores your textures separately for each port. 0 selects
    /// any free port
    #[arg(long, default_value_t = PORT, value_name = "PORT")]
    port: u16,
}

impl Studio {
    pub(crate) fn run(self) -> Result {
        let folder = shared::page(self.folder.as_deref(), "the studio's page", page_in)?;
        let served = ServedFolder::open(&folder, self.port, &key()?)
            .map_err(|error| Failure::Other(error.to_string()))?;
        print(&format!("the studio is at {}; Ctrl-C ends it\n", served.url()))?;
        signals::ask();
        while !signals::interrupted() {
            std::thread::sleep(NOTICED);
        }
        Ok(Exit::SUCCESS)
    }
}

/// Returns the user's secret key, from which the address is derived. If there is no folder to store
/// the key, key and address are new every time.
fn key() -> Result<Key> {
    let config = htex_host::folders::config();
    if let Some(key) = config.and_then(|folder| Key::load_or_create(&folder, KEY).ok()) {
        return Ok(key);
    }
    warn(&["there is no folder of settings that only you can write to; the next time the studio has another address, at which the browser does not find textures that you stored".to_owned()]);
    Key::passing().map_err(|error| Failure::Other(format!("there are no random numbers: {error}")))
}

/// Returns the folder that contains `index.html`: the subfolder [`STATIC`] of this folder, or else
/// this folder itself. Does not follow links inside the folder.
fn page_in(folder: &Path) -> Option<PathBuf> {
    let own = OwnFolder::new(folder);
    let has_page = |place: &&str| {
        let page = own.entry_path(&Path::new(place).join("index.html"));
        page.is_ok_and(|page| page.is_file())
    };
    let place = [STATIC, ""].into_iter().find(|place| has_page(place))?;
    Some(folder.join(place))
}
