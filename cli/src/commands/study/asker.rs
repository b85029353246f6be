//! How a session asks its participant, and the source of the finger's motion.

use clap::Args;
use htex_lab::study::{Asker, Key, Page, PageOptions, Study, View};
use htex_scene::file::Motion;

use super::terminal::Terminal;
use crate::failure::{Failure, Result};
use crate::motions::Motions;
use crate::output::tell;

/// Size of a page's pixel by the definition of CSS, millimetres. Real screens differ.
const CSS_PIXEL_MM: &str = "0.2646";

/// Options that set where a session asks its questions, and which source measures the finger's
/// motion in a study with live motion.
#[derive(Args)]
#[command(next_help_heading = "Session")]
pub(super) struct AskingArgs {
    /// Ask the questions on a web page of this machine instead of in the terminal. The command
    /// prints the address of the page
    #[arg(long)]
    page: bool,

    /// Port of the page [default: any free port]
    #[arg(
        long,
        value_name = "PORT",
        requires = "page",
        default_value_t = 0,
        hide_default_value = true
    )]
    port: u16,

    /// Source of the finger's motion, for a study with live motion: `-` reads lines
    /// `speed_mm_s force_n [x_mm y_mm]` from standard input, `page` follows a finger on the page
    #[arg(long, value_name = "SOURCE", value_parser = ["-", "page"])]
    motion: Option<String>,

    /// Width of one pixel of the page, mm, for --motion page. To find it, measure the width of 1000
    /// pixels on your screen and divide by 1000
    #[arg(long, value_name = "MM", default_value = CSS_PIXEL_MM, value_parser = positive)]
    touch_mm_per_px: f64,

    /// With --motion page: normal force of the finger, N. The page cannot measure the force, so
    /// htex assumes this value
    #[arg(long, value_name = "N", default_value = "0.4", value_parser = positive)]
    touch_force: f64,
}

/// The object that asks the questions, and the source of live motions.
pub(super) struct SessionInput {
    pub(super) asker: Box<dyn Asker>,
    pub(super) motions: Option<Motions>,
}

fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok();
    let sound = number.filter(|x| *x > 0.0 && *x <= 1000.0);
    sound.ok_or_else(|| "a number above 0, at most 1000".to_owned())
}

impl AskingArgs {
    /// Refuses a combination that cannot work.
    pub(super) fn check(&self, study: &Study, is_simulated: bool) -> Result<()> {
        let is_live = study.motion == Motion::Live;
        let source = self.motion.as_deref();
        let problem = match source {
            None if is_live => {
                "the study's motion is live; give it with --motion - or --motion page"
            }
            Some(_) if !is_live => "--motion: the study's motion is not live",
            Some("page") if is_simulated => {
                "--motion page: a simulated participant has no page; give lines with --motion -"
            }
            Some("page") if !self.page => "--motion page needs --page",
            Some("-") if !self.page && !is_simulated => {
                "--motion -: standard input cannot be both the motion and the answers; ask on a page (--page)"
            }
            _ if self.page && is_simulated => "--page: a simulated participant has no page",
            _ if study.masking_noise.is_some() && !self.page && !is_simulated => {
                "the study has masking noise, which the page plays; give --page"
            }
            _ => return Ok(()),
        };
        Err(Failure::Usage(problem.to_owned()))
    }

    /// Whether the participant's answers or the motion come from standard input.
    pub(super) fn reads_stdin(&self, is_simulated: bool) -> bool {
        self.motion.as_deref() == Some("-") || !(self.page || is_simulated)
    }

    /// Returns the input for a simulated participant, who is not asked anything.
    pub(super) fn nobody(&self) -> SessionInput {
        SessionInput {
            asker: Box::new(Nobody),
            motions: self.motion.is_some().then(Motions::from_stdin),
        }
    }

    /// Opens the terminal or the page that asks a real participant.
    pub(super) fn open(&self, study: &Study, participant: &str) -> Result<SessionInput> {
        if !self.page {
            return Ok(SessionInput { asker: Box::new(Terminal::new()), motions: None });
        }
        let is_touched = self.motion.as_deref() == Some("page");
        let title = match &study.name[..] {
            "" => participant.to_owned(),
            name => format!("{name} – {participant}"),
        };
        let page = Page::open(PageOptions {
            port: self.port,
            title,
            noise_dbfs: study.masking_noise.as_ref().map(|noise| noise.level_dbfs),
            touch_mm_per_px: is_touched.then_some(self.touch_mm_per_px),
        })?;
        tell!("open {}", page.address());
        let motions = match self.motion.as_deref() {
            Some("page") => Some(Motions::Page(page.touch(), self.touch_force)),
            Some(_) => Some(Motions::from_stdin()),
            None => None,
        };
        let asker = Box::new(page);
        Ok(SessionInput { asker, motions })
    }
}

/// A simulated participant is not asked anything.
struct Nobody;

impl Asker for Nobody {
    fn show(&mut self, _: &View, _: usize, _: usize) {}

    fn key(&mut self) -> Option<Key> {
        None
    }
}
