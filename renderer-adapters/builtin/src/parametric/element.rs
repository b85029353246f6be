//! The haptic element of a hand, reserved for one open device. OpenXR calls an actuator a haptic
//! element.

use std::sync::Arc;

use htex_device::DeviceError;

use crate::driver::Claim;
use crate::parametric::session::{Hand, Session};

/// A reserved haptic element. Dropping this value releases the element.
pub(crate) struct Element {
    pub(crate) session: Arc<Session>,
    pub(crate) hand: Hand,
    _claim: Claim,
}

impl Element {
    pub(crate) fn reserve(runtime: &str, hand: Hand) -> Result<Self, DeviceError> {
        let session = Session::shared(runtime)?;
        let claim = Claim::reserve(
            ["parametric", runtime, hand.name()],
            &format!("the {} hand", hand.name()),
        )?;
        Ok(Self { session, hand, _claim: claim })
    }

    pub(crate) fn stop(&self) -> Result<(), String> {
        self.session.stop(self.hand)
    }
}
