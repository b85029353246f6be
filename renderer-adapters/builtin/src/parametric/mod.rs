//! Controllers behind an OpenXR runtime, which receive either points (an amplitude and a frequency)
//! or samples, several times per second.
//!
//! The adapter is not linked to an OpenXR library, but loads a runtime or the installed loader at
//! run time. The setting `form` chooses what is played:
//! - `form=points` plays `XR_EXT_haptic_parametric`. Each block of `block_ms` becomes a point with
//!   the amplitude and the frequency at the end of the block ([`htex_dsp::reduced::Points`]). The
//!   adapter passes the points to the runtime in frames. A frame has the duration that the runtime
//!   prefers.
//! - `form=pcm` plays `XR_FB_haptic_pcm`: the samples themselves, at the controller's sample rate.
//! - `form=pwle` plays piecewise linear envelopes, which Android's vibrators accept. The adapter
//!   plays them through functions that the application exports.
//!
//! The adapter has its own session without graphics (`XR_MND_headless`), so that a program without
//! graphics, such as the command `htex`, can play on a controller. A session ends when its last
//! device is closed. If the program hangs, the runtime ends a stream of points after 50 ms. A
//! stream of samples ends when the runtime has played all samples that it received.
#![deny(unsafe_code)]

mod element;
mod envelopes;
mod instance;
mod points;
mod samples;
mod session;
mod settings;
mod structures;
mod table;

use std::sync::LazyLock;

use crate::motor::{Motor, PacedOutput, rate_error};
use htex_device::{
    Adapter, Capabilities, Descriptor, DeviceError, Endpoint, Mapping, Output, Rates, Settings,
    StreamFormat,
};

use element::Element;
use envelopes::{Envelopes, Vibrator, milliseconds};
use points::Stream;
use samples::Samples;
use session::{Hand, Session};
use settings::{Form, PlayRequest};

/// The adapter for parametric haptics. See the crate's documentation.
#[derive(Debug, Clone, Copy, Default)]
pub struct Parametric;

impl Adapter for Parametric {
    fn descriptor(&self) -> &Descriptor {
        &DESCRIPTOR
    }

    /// Lists the hands on which the installed runtime can play.
    fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError> {
        let session = Session::shared("")?;
        let plays = |hand: &Hand| {
            let points = session.properties(*hand).map(|_| "points");
            points.or_else(|_| session.pcm_rate_hz(*hand).map(|_| "samples (form=pcm)"))
        };
        let endpoint = |hand: Hand| {
            let what = plays(&hand).ok()?;
            Some(Endpoint {
                name: hand.name().to_owned(),
                setting: "hand".to_owned(),
                summary: format!("controller that plays {what}"),
            })
        };
        Ok(Hand::ALL.into_iter().filter_map(endpoint).collect())
    }

    fn capabilities(&self, settings: &Settings) -> Result<Capabilities, DeviceError> {
        let asked = PlayRequest::new(settings)?;
        match asked.form {
            Form::Pwle => asked.of_vibrator(),
            Form::Points | Form::Pcm => asked.of_session(&*Session::shared(&asked.runtime)?),
        }
    }

    fn open_output(
        &self,
        settings: &Settings,
        format: &StreamFormat,
    ) -> Result<Box<dyn Output>, DeviceError> {
        let asked = PlayRequest::new(settings)?;
        match asked.form {
            Form::Pwle => {
                let can = asked.of_vibrator()?;
                let motor = |_| Ok(Box::new(Envelopes::open(&asked.runtime, &asked.plan)?) as _);
                asked.paced("Vibrator", can, format, motor)
            }
            Form::Points | Form::Pcm => {
                let element = Element::reserve(&asked.runtime, asked.hand)?;
                let can = asked.of_session(&element.session)?;
                let name = format!("OpenXR, {} hand", asked.hand.name());
                let motor = |rate_hz| asked.motor(element, rate_hz);
                asked.paced(&name, can, format, motor)
            }
        }
    }
}

impl PlayRequest {
    /// Returns the capabilities of a vibrator with these settings.
    fn of_vibrator(&self) -> Result<Capabilities, DeviceError> {
        Vibrator::load(&self.runtime)?.takes(milliseconds(&self.plan))?;
        Ok(self.plan.capabilities())
    }

    /// Returns the capabilities of a controller with these settings. For points, any sample rate is
    /// possible. Samples must have the controller's rate.
    fn of_session(&self, session: &Session) -> Result<Capabilities, DeviceError> {
        let can = self.plan.capabilities();
        if self.form != Form::Pcm {
            let properties = session.properties(self.hand);
            return properties.map(|_| can).map_err(DeviceError::Missing);
        }
        let rate_hz = session.pcm_rate_hz(self.hand).map_err(DeviceError::Missing)?;
        Ok(Capabilities {
            rates: Rates::List(vec![rate_hz]),
            default_rate_hz: rate_hz,
            block_frames: self.plan.block_frames(rate_hz) as u32,
            ..can
        })
    }

    fn motor(&self, element: Element, rate_hz: f64) -> Result<Box<dyn Motor>, DeviceError> {
        match self.form {
            Form::Pcm => Ok(Box::new(Samples::open(element, &self.plan, rate_hz)?)),
            _ => Ok(Box::new(Stream::open(element, &self.plan, self.range_hz, rate_hz)?)),
        }
    }

    /// Opens an output for a motor. Creates the motor only if the output supports the rate.
    fn paced(
        &self,
        name: &str,
        can: Capabilities,
        format: &StreamFormat,
        motor: impl FnOnce(f64) -> Result<Box<dyn Motor>, DeviceError>,
    ) -> Result<Box<dyn Output>, DeviceError> {
        let rate_hz = format.rate_hz;
        if !can.has_rate(rate_hz) {
            return Err(rate_error(name, rate_hz, &can));
        }
        let paced = PacedOutput::open(name, motor(rate_hz)?, &self.plan, can, format)?;
        Ok(Box::new(paced))
    }
}

static DESCRIPTOR: LazyLock<Descriptor> = LazyLock::new(|| {
    Descriptor {
        id: "org.htex.parametric".to_owned(),
        name: "OpenXR controller".to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        summary: "Points or samples on a controller, through an OpenXR runtime.".to_owned(),
        settings: settings::all(),
        mapping: Some(Mapping {
            plays: "form=points: an amplitude and a frequency for each block of block_ms, which the runtime interpolates (XR_EXT_haptic_parametric); \
                    form=pcm: the samples, at the controller's rate; form=pwle: effects of control points, one point for each block"
                .to_owned(),
            loses: "form=points: the spectrum, except its level and mean frequency, changes within a block, and frequencies \
                    outside the controller's range; form=pcm: frequencies above half of the controller's rate; form=pwle: the same as with form=points, and each effect of about 0.1 s \
                    begins with a ramp from rest"
                .to_owned(),
        }),
        ..Descriptor::default()
}
});
