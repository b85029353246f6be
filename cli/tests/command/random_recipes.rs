//! Random recipes and tables in a folder with traps: links, pipes, devices, servers of this
//! machine.

use std::collections::BTreeMap;
use std::fs;
use std::net::TcpListener;
use std::os::unix::fs::symlink;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use crate::common::{Place, Random};

/// Most memory of a build, KiB.
const MOST_KIB: i64 = 512 << 10;
/// Longest time of a build.
const LONGEST: Duration = Duration::from_secs(30);

/// A recipe without a trap.
const PLAIN: &str = "[library]\nname = \"lib\"\n[[textures]]\nrecordings = \"rec/*.csv\"\nmodels = [\"bands\"]\n\
                     at = { speed_mm_s = 80, force_n = 0.4 }\n";

/// A folder of somebody else, inside one in which nothing may change.
struct Traps {
    place: Place,
    /// Addresses of servers of this machine.
    addresses: Vec<String>,
    requests: Arc<AtomicUsize>,
}

impl Traps {
    fn new() -> Self {
        let place = Place::new();
        for folder in ["work/rec", "work/traps", "outside/folder"] {
            fs::create_dir_all(place.path(folder)).unwrap();
        }
        for (surface, file) in [("vinyl", "a"), ("sandpaper", "b")] {
            let file = format!("work/rec/{file}.csv");
            place.simulated(&file, &["--surface", surface, "--seconds", "1"]);
        }
        fs::copy(place.path("work/rec/a.csv"), place.path("outside/a.csv")).unwrap();
        for victim in ["victim", "victim.part", "folder/victim.htex", "folder/victim.part"] {
            fs::write(place.path("outside").join(victim), "precious").unwrap();
        }
        let traps = place.path("work/traps");
        for (link, to) in [
            ("zero", "/dev/zero"),
            ("random.csv", "/dev/urandom"),
            ("full", "/dev/full"),
            ("nowhere.csv", "/nowhere"),
            ("loop", "."),
            ("outside", "../../outside"),
            ("victim.csv", "../../outside/victim"),
        ] {
            symlink(to, traps.join(link)).unwrap();
        }
        for pipe in ["pipe", "pipe.csv", "pipe.toml", "pipe.wasm"] {
            let made = std::process::Command::new("mkfifo").arg(traps.join(pipe)).status();
            assert!(made.unwrap().success());
        }
        // A terabyte of nothing.
        let huge = fs::File::create(traps.join("huge.csv")).unwrap();
        huge.set_len(1 << 40).unwrap();
        fs::write(traps.join("m.so"), b"\x7fELF").unwrap();
        fs::write(traps.join("m.wasm"), b"\0asm\x01\0\0\0").unwrap();
        let requests = Arc::new(AtomicUsize::new(0));
        let mut addresses = Vec::new();
        for host in ["127.0.0.1", "[::1]"] {
            let Ok(listener) = TcpListener::bind(format!("{host}:0")) else {
                continue;
            };
            let port = listener.local_addr().unwrap().port();
            addresses.push(format!("http://{host}:{port}"));
            addresses.push(format!("http://localhost:{port}"));
            addresses.push(format!("http://[::ffff:127.0.0.1]:{port}"));
            addresses.push(format!("https://{host}:{port}"));
            let counted = requests.clone();
            std::thread::spawn(move || {
                for stream in listener.incoming() {
                    counted.fetch_add(1, Ordering::SeqCst);
                    drop(stream);
                }
            });
        }
        addresses.extend(
            ["http://169.254.169.254", "http://10.0.0.1", "http://0", "http://2130706433"]
                .map(str::to_owned),
        );
        Self { place, addresses, requests }
    }

    fn path(&self, random: &mut Random) -> String {
        // Mostly what is right, so that builds come far.
        if !random.one_in(6) {
            return random.of(&["rec/a.csv", "rec/b.csv"]).to_owned();
        }
        if random.one_in(6) {
            let address = &self.addresses[random.below(self.addresses.len())];
            return format!("{address}/{}", random.of(&["a.csv", "m.so", "t.csv?x=1", ""]));
        }
        random
            .of(&[
                "rec/a.csv",
                "rec/b.csv",
                "./rec/../rec/a.csv",
                "table.csv",
                "traps/zero",
                "traps/random.csv",
                "traps/full",
                "traps/nowhere.csv",
                "traps/loop/a",
                "traps/outside/a.csv",
                "traps/victim.csv",
                "traps/pipe",
                "traps/pipe.csv",
                "traps/pipe.wasm",
                "traps/huge.csv",
                "traps/m.so",
                "traps/m.wasm",
                "/dev/zero",
                "/dev/stdin",
                "/dev/tty",
                "/proc/self/mem",
                "/proc/kmsg",
                "/proc/self/environ",
                "../outside/a.csv",
                "../outside/victim",
                "library.toml",
                "",
                ".",
                "..",
                "rec",
                "file:///dev/zero",
                "file://rec/a.csv",
                "dist/.htex-build/lock",
                "a\\u0000b",
            ])
            .to_owned()
    }

    fn glob(&self, random: &mut Random) -> String {
        match random.below(8) {
            4.. => random.of(&["rec/*.csv", "rec/a.csv"]).to_owned(),
            0 => self.path(random),
            1 => random
                .of(&["rec/*.csv", "**/*.csv", "rec/{a,b}.csv", "../outside/*.csv", "traps/*"])
                .to_owned(),
            2 => random
                .of(&[
                    "**",
                    "../**/*",
                    "traps/**/*.csv",
                    "[",
                    "{",
                    "{a,{b,{c,{d,{e,{f,{g,{h,{i}}}}}}}}}",
                    "*{",
                    "[!a-",
                    "rec/[a-b].csv",
                ])
                .to_owned(),
            _ => random
                .of(&["{", "[", "*", "?", "**/", "{a,", "../", "a/"])
                .repeat(1 + random.below(5000)),
        }
    }

    fn name(random: &mut Random) -> &'static str {
        if !random.one_in(6) {
            return random.of(&["{stem}", "{folder}/{stem}"]);
        }
        random.of(&[
            "{stem}",
            "{file}",
            "{folder}/{stem}",
            "../{stem}",
            "/{stem}",
            "a/../../{stem}",
            "{name}{name}",
            "{stem}.htex/x",
            "{x}",
            "{",
            "}",
            "{{stem}}",
            "CON",
            "a\\u0000b",
            "one",
            "{a}{a}{a}{a}{a}{a}{a}{a}",
            "victim",
            "folder/victim",
        ])
    }

    fn recipe(&self, random: &mut Random) -> String {
        let mut text = format!(
            "[library]\nname = \"{}\"\n",
            if random.one_in(16) { random.of(&["../lib", "a/b", "", "lib.part"]) } else { "lib" }
        );
        if random.one_in(12) {
            text += &format!("plugins = [\"{}\"]\n", self.path(random));
        }
        if random.one_in(8) {
            text += "[defaults]\nlicense = \"CC0-1.0\"\n";
        }
        for _ in 0..1 + random.below(3) / 2 {
            text += "[[textures]]\n";
            text += &match random.below(4) {
                0 if random.one_in(3) => format!("table = \"{}\"\n", self.path(random)),
                0 | 1 => "table = \"table.csv\"\n".to_owned(),
                _ => format!("recordings = \"{}\"\n", self.glob(random)),
            };
            let optional: [(&str, String); 9] = [
                ("name", Self::name(random).to_owned()),
                (
                    "pattern",
                    random
                        .of(&[
                            "(?<a>.*)",
                            "(?<a>(",
                            "(a{1000}){1000}",
                            "(?<a>x*)*",
                            ".*(?<name>.).*",
                        ])
                        .to_owned(),
                ),
                ("tracker", self.path(random)),
                ("response", self.path(random)),
                ("embed_plugins", self.path(random)),
                ("description", "{a}".repeat(random.below(2000))),
                ("tags", Self::name(random).to_owned()),
                ("grid", random.of(&["auto", "speed=1", "speed="]).to_owned()),
                ("map", random.of(&["lateral=#2", "lateral=((((", "lateral=a+b"]).to_owned()),
            ];
            for (key, value) in optional {
                if random.one_in(12) {
                    text += &match key {
                        "embed_plugins" | "tags" => format!("{key} = [\"{value}\"]\n"),
                        _ => format!("{key} = \"{value}\"\n"),
                    };
                }
            }
            text += "models = [\"bands\"]\nat = { speed_mm_s = 80, force_n = 0.4 }\n";
            if random.one_in(5) {
                text += random.of(&[
                    "gates = { strict = true }\n",
                    "gates = { max_bytes = 1 }\n",
                    "gates = { max_band_error_db = { ar = 1 } }\n",
                ]);
            }
        }
        if random.one_in(8) {
            text += &format!(
                "[[overrides]]\ntextures = \"{}\"\nlevel = \"fitted\"\n",
                self.glob(random)
            );
        }
        text
    }

    fn table(&self, random: &mut Random) -> String {
        let mut text = random
            .of(&[
                "recording,a,name\n",
                "recording,a,name\n",
                "recording,a,name\n",
                "recording,a,b\n",
                "recording,a,b\n",
                "recording,a,b\n",
                "recording,a\n",
                "a,recording,speed_mm_s\n",
                "name\n",
                "",
            ])
            .to_owned();
        let rows = match random.below(8) {
            0 => random.below(3000),
            _ => random.below(5),
        };
        for row in 0..rows {
            let cell = match random.below(6) {
                0 => "x".repeat(random.below(100_000)),
                1 => "\"a\nb".to_owned(),
                _ => format!("{}{row}", random.of(&["=1+", "80", "é", "../"])),
            };
            text += &format!("{},{cell},{}\n", self.path(random), Self::name(random));
            if text.len() > 2 << 20 {
                break;
            }
        }
        text
    }

    /// A folder of results, with links in it.
    fn dist(&self, random: &mut Random) {
        let dist = self.place.path("work/dist");
        // Half of them stay as the build before left them.
        if random.one_in(2) {
            return;
        }
        let _ = fs::remove_dir_all(&dist);
        for _ in 0..random.below(4) {
            let name = random.of(&[
                ".htex-build",
                ".htex-build/lock",
                ".htex-build/made",
                ".htex-build/parts",
                ".htex-build/elsewhere",
                ".htex-build/files.json",
                ".htex-build/library.json",
                ".htex-build/fits.json",
                "textures",
                "textures/a.htex",
                "sounds",
                "index.html",
                "build-report.json",
                "lib.htexlib",
                "browser",
                "textures/folder",
            ]);
            let to = random.of(&["victim", "victim.part", "folder", "", "nothing"]);
            let link = dist.join(name);
            let is_free = fs::create_dir_all(link.parent().unwrap()).is_ok()
                && link.symlink_metadata().is_err();
            // Only in the folder itself: what is above may be a link that was made before.
            if is_free
                && link
                    .parent()
                    .unwrap()
                    .canonicalize()
                    .unwrap()
                    .starts_with(dist.canonicalize().unwrap())
            {
                symlink(self.place.path("outside").join(to), link).unwrap();
            }
        }
    }

    /// All files and their bytes, except results and files in the user's own folders.
    fn untouched(&self) -> BTreeMap<PathBuf, Vec<u8>> {
        let mut files = BTreeMap::new();
        let mut folders = vec![self.place.path("")];
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(&folder).unwrap() {
                let path = entry.unwrap().path();
                let is = path.symlink_metadata().unwrap();
                let own = ["work/dist", "errors", "config", "cache"];
                if own.iter().any(|own| path == self.place.path(own)) {
                    continue;
                }
                if is.is_dir() {
                    files.insert(path.clone(), Vec::new());
                    folders.push(path);
                } else if is.is_file() && is.len() < 1 << 24 {
                    files.insert(path.clone(), fs::read(&path).unwrap());
                } else {
                    files.insert(path, is.len().to_le_bytes().to_vec());
                }
            }
        }
        files
    }
}

/// Flips bytes of a text.
fn mutated(text: String, random: &mut Random) -> Vec<u8> {
    let mut bytes = text.into_bytes();
    if random.one_in(16) && !bytes.is_empty() {
        for _ in 0..=random.below(4) {
            let at = random.below(bytes.len());
            bytes[at] = random.next() as u8;
        }
    }
    bytes
}

fn build(traps: &Traps, arguments: &[&str]) -> (crate::common::measured::End, Duration) {
    let mut command = traps.place.command(arguments);
    command
        .current_dir(traps.place.path("work"))
        .stdin(std::process::Stdio::null())
        .env("HTEX_STORAGE_TIMEOUT_S", "5")
        .env("HTEX_CONFIG_DIR", traps.place.path("config"))
        .env("HTEX_CACHE_DIR", traps.place.path("cache"));
    for proxy in
        ["HTTP_PROXY", "HTTPS_PROXY", "ALL_PROXY", "http_proxy", "https_proxy", "all_proxy"]
    {
        command.env_remove(proxy);
    }
    let start = Instant::now();
    let end = crate::common::measured::run(&mut command, &traps.place.path("errors"));
    (end, start.elapsed())
}

#[test]
fn any_recipe_stays_in_its_folder() {
    let count: u64 = if xtask::prove::whole() { 10_000 } else { 300 };
    let traps = Traps::new();
    fs::create_dir(traps.place.path("config")).unwrap();
    fs::set_permissions(
        traps.place.path("config"),
        std::os::unix::fs::PermissionsExt::from_mode(0o700),
    )
    .unwrap();
    // Makes the key.
    fs::write(traps.place.path("work/library.toml"), PLAIN).unwrap();
    let (end, _) = build(&traps, &["build", "library.toml", "-o", "dist"]);
    assert_eq!(end.code, 0, "{}", end.error);
    assert!(traps.place.path("work/dist/lib.htexlib").exists());
    let (mut codes, mut most_kib, mut longest) = ([0_usize; 4], 0, Duration::ZERO);
    for seed in 0..count {
        let mut random = Random(seed);
        let recipe = mutated(traps.recipe(&mut random), &mut random);
        let table = mutated(traps.table(&mut random), &mut random);
        fs::write(traps.place.path("work/library.toml"), &recipe).unwrap();
        fs::write(traps.place.path("work/table.csv"), &table).unwrap();
        traps.dist(&mut random);
        let before = traps.untouched();
        let mut arguments = vec!["build", "library.toml", "-o", "dist"];
        for flag in ["--keep-going", "--dry-run", "--prune", "--json"] {
            if random.one_in(3) {
                arguments.push(flag);
            }
        }
        if random.one_in(6) {
            arguments = vec!["validate", "library.toml"];
        }
        let (end, took) = build(&traps, &arguments);
        let shown = || {
            format!(
                "seed {seed}, {arguments:?}:\n{}\n{}",
                String::from_utf8_lossy(&recipe),
                cut(&end.error)
            )
        };
        assert!((0..=3).contains(&end.code), "{}: {}", end.code, shown());
        assert!(!end.error.contains("panicked"), "{}", shown());
        assert!(took < LONGEST, "{took:?}: {}", shown());
        assert!(end.memory_kib < MOST_KIB, "{} KiB: {}", end.memory_kib, shown());
        let after = traps.untouched();
        let differs = |path: &&PathBuf| before.get(*path) != after.get(*path);
        let all = before.keys().chain(after.keys());
        let changed: Vec<&PathBuf> = all.filter(differs).collect();
        assert!(changed.is_empty(), "{changed:?}: {}", shown());
        assert_eq!(traps.requests.load(Ordering::SeqCst), 0, "{}", shown());
        codes[end.code as usize] += 1;
        most_kib = most_kib.max(end.memory_kib);
        longest = longest.max(took);
    }
    println!(
        "{count} recipes: exit status 0 to 3 {codes:?}, at most {most_kib} KiB and {longest:?}"
    );
    // Some are built, or nothing was tried.
    assert!(codes[0] > count as usize / 50, "{codes:?}");
}

fn cut(text: &str) -> String {
    text.chars().take(2000).collect()
}
