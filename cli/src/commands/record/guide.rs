//! Where the person who records is guided: in the terminal or on a page.

use std::time::Duration;

use clap::Args;
use htex_lab::record::{Guidance, GuidePage, Moment, Next, RecordError, Recorded, Setup};

use super::screen::Screen;
use crate::failure::Failure;
use crate::output::tell;
use crate::signals;

/// Time between two looks at whether the page was asked to start.
const LOOK: Duration = Duration::from_millis(20);

/// What the guidance shows, and where.
#[derive(Args)]
#[command(next_help_heading = "Guidance")]
pub(super) struct GuideArgs {
    /// Guide on a page in a browser of this machine, whose address is printed, not in the terminal;
    /// the session begins when it is started there
    #[arg(long)]
    page: bool,

    /// Port of the page [default: any that is free]
    #[arg(
        long,
        value_name = "PORT",
        requires = "page",
        default_value_t = 0,
        hide_default_value = true
    )]
    port: u16,

    /// Length of the strokes that the guidance shows
    #[arg(long, value_name = "MM", default_value_t = 80.0)]
    stroke: f64,
}

impl GuideArgs {
    /// The target that is shown.
    pub(super) fn guidance(&self, setup: &Setup) -> Result<Guidance, Failure> {
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

    pub(super) fn open(
        &self,
        setup: &Setup,
        guidance: Guidance,
        rate_hz: f64,
    ) -> Result<Guide, Failure> {
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

/// What guides.
pub(super) enum Guide {
    Screen(Box<Screen>),
    Page(GuidePage),
}

impl Guide {
    /// Waits for the start of the session on a page.
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

    /// Shows a moment, and returns whether the session goes on.
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

    /// Shows a take that is complete.
    pub(super) fn told(&mut self, take: &Recorded) {
        match self {
            Self::Screen(screen) => screen.end(),
            Self::Page(page) => page.told(take),
        }
    }

    /// Shows how the session has ended.
    pub(super) fn end(&mut self, recorded: &Result<Recorded, RecordError>) {
        match self {
            Self::Screen(screen) => screen.end(),
            Self::Page(page) => page.end(recorded),
        }
    }
}
