//! Guidance for the person who records, in the terminal or on a web page.

use std::time::Duration;

use clap::Args;
use htex_lab::LabError;
use htex_lab::record::{Guidance, GuidePage, Moment, Next, Setup, TakeReport};

use super::screen::Screen;
use crate::failure::{Failure, Result};
use crate::output::tell;
use crate::signals;

/// Polling interval for the start request of the page.
const LOOK: Duration = Duration::from_millis(20);

/// Options for the guidance, which shows a person how to move the finger. They choose where the
/// guidance appears and which strokes it shows.
#[derive(Args)]
#[command(next_help_heading = "Guidance")]
pub(super) struct GuideArgs {
    /// Show the guidance on a web page of this machine instead of in the terminal. The command
    /// prints the address of the page. You start the session on the page
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

    /// Length of the strokes that the guidance shows, mm
    #[arg(long, value_name = "MM", default_value_t = 80.0)]
    stroke: f64,
}

impl GuideArgs {
    /// Returns the motion that the guidance shows as the target.
    pub(super) fn guidance(&self, setup: &Setup) -> Result<Guidance> {
        if !(self.stroke > 0.0 && self.stroke <= 1e4) {
            let sentence = format!("--stroke {}: above 0 and at most 10,000 mm", self.stroke);
            return Err(Failure::Usage(sentence));
        }
        Ok(Guidance {
            speed_mm_s: setup.target.speed_mm_s,
            force_n: setup.target.force_n,
            tolerance: setup.tolerance,
            stroke_mm: self.stroke,
        })
    }

    pub(super) fn open(&self, setup: &Setup, guidance: Guidance, rate_hz: f64) -> Result<Guide> {
        if !self.page {
            return Ok(Guide::Screen(Box::new(Screen::new(
                guidance,
                setup.required,
                setup.quantity,
                rate_hz,
            ))));
        }
        let page = GuidePage::open(self.port, setup, guidance, rate_hz)?;
        tell!("open {}", page.address());
        Ok(Guide::Page(page))
    }
}

/// The place where guidance is shown.
pub(super) enum Guide {
    Screen(Box<Screen>),
    Page(GuidePage),
}

impl Guide {
    /// Waits until the user starts the session on the page. In a terminal, does not wait.
    pub(super) fn wait_for_start(&self) -> Next {
        let Self::Page(page) = self else {
            return Next::Go;
        };
        while !page.has_started() {
            if self.is_left() {
                return Next::Stop;
            }
            std::thread::sleep(LOOK);
        }
        Next::Go
    }

    /// Shows a moment of the session. Returns whether the session continues.
    pub(super) fn show(&mut self, moment: &Moment<'_>) -> Next {
        match self {
            Self::Screen(screen) => screen.show(moment),
            Self::Page(page) => page.show(moment),
        }
        if self.is_left() { Next::Stop } else { Next::Go }
    }

    fn is_left(&self) -> bool {
        let is_stopped = match self {
            Self::Screen(_) => false,
            Self::Page(page) => page.is_stopped(),
        };
        is_stopped || signals::interrupted()
    }

    /// Shows a complete take.
    pub(super) fn told(&mut self, take: &TakeReport) {
        match self {
            Self::Screen(screen) => screen.end(),
            Self::Page(page) => page.told(take),
        }
    }

    /// Shows how the session ended.
    pub(super) fn end(&mut self, recorded: &Result<TakeReport, LabError>) {
        match self {
            Self::Screen(screen) => screen.end(),
            Self::Page(page) => page.end(recorded),
        }
    }
}
