//! An OpenXR session with one haptic action on both hands.
//!
//! A runtime allows a program only one session at a time. Therefore, the devices of both hands
//! share a session, which ends when the last device is closed.
#![allow(unsafe_code)] // The runtime's functions are C.

use std::collections::BTreeMap;
use std::ffi::CStr;
use std::ptr::null;
use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::thread::sleep;
use std::time::{Duration, Instant};

use htex_device::DeviceError;
use openxr_sys::{self as xr, Handle as _};

use crate::parametric::instance::{Instance, fixed};
use crate::parametric::structures::{PROPERTIES, Properties};
use crate::parametric::table::{done, entry};

/// Time within which a session must get the focus.
const FOCUS: Duration = Duration::from_secs(5);
const LOOK: Duration = Duration::from_millis(5);

/// Which controller plays.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Hand {
    Left,
    Right,
}

impl Hand {
    pub(crate) const ALL: [Self; 2] = [Self::Left, Self::Right];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Left => "left",
            Self::Right => "right",
        }
    }

    fn user(self) -> &'static CStr {
        match self {
            Self::Left => c"/user/hand/left",
            Self::Right => c"/user/hand/right",
        }
    }

    fn output(self) -> &'static CStr {
        match self {
            Self::Left => c"/user/hand/left/output/haptic",
            Self::Right => c"/user/hand/right/output/haptic",
        }
    }
}

/// The interaction profiles of OpenXR 1.0 whose controllers have a haptic element.
const PROFILES: [&CStr; 6] = [
    c"/interaction_profiles/khr/simple_controller",
    c"/interaction_profiles/oculus/touch_controller",
    c"/interaction_profiles/valve/index_controller",
    c"/interaction_profiles/htc/vive_controller",
    c"/interaction_profiles/microsoft/motion_controller",
    c"/interaction_profiles/hp/mixed_reality_controller",
];

/// The sessions in use. The key is the setting that named the runtime.
static IN_USE: Mutex<BTreeMap<String, Weak<Session>>> = Mutex::new(BTreeMap::new());

/// A session that has the focus or has lost it.
pub(crate) struct Session {
    handle: xr::Session,
    action: xr::Action,
    action_set: xr::ActionSet,
    hands: [xr::Path; 2],
    /// The lock lets only one thread at a time poll events and control the motors.
    state: Mutex<State>,
    /// Dropped after the session: `Drop` of a struct runs before its fields are dropped.
    instance: Instance,
}

#[derive(Debug, Clone, Copy)]
struct State {
    now: xr::SessionState,
    begun: bool,
}

impl Session {
    /// Returns the session of the runtime that a setting names. Creates the session if no device
    /// uses it yet.
    pub(crate) fn shared(path: &str) -> Result<Arc<Self>, DeviceError> {
        // The lock is held until the new session is in the map, so that two threads cannot create
        // two sessions.
        let mut in_use = IN_USE.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(session) = in_use.get(path).and_then(Weak::upgrade) {
            return Ok(session);
        }
        let entry = entry(path)?;
        let made = Instance::create(entry).and_then(Self::begin);
        let session = made.map_err(|what| {
            let runtime = if path.is_empty() { "the installed runtime" } else { path };
            DeviceError::Missing(format!("OpenXR, {runtime}: {what}"))
        })?;
        let session = Arc::new(session);
        in_use.insert(path.to_owned(), Arc::downgrade(&session));
        Ok(session)
    }

    fn begin(instance: Instance) -> Result<Self, String> {
        let hands = [instance.path(Hand::Left.user())?, instance.path(Hand::Right.user())?];
        let info = xr::SessionCreateInfo {
            ty: xr::SessionCreateInfo::TYPE,
            next: null(),
            create_flags: xr::SessionCreateFlags::EMPTY,
            system_id: instance.system,
        };
        let mut handle = xr::Session::NULL;
        // SAFETY: the structure is laid out as the header declares it. Without graphics no
        // structure follows it.
        let code = unsafe { (instance.table.create_session)(instance.handle, &info, &mut handle) };
        done("xrCreateSession", code)?;
        // `Self` is built before the next calls, so that `drop` destroys the session if one of
        // these calls fails.
        let mut session = Self {
            handle,
            action: xr::Action::NULL,
            action_set: xr::ActionSet::NULL,
            hands,
            state: Mutex::new(State { now: xr::SessionState::IDLE, begun: false }),
            instance,
        };
        session.make_action()?;
        // The runtime refuses suggestions once the action set is attached.
        session.suggest()?;
        session.attach()?;
        session.wait_for_focus()?;
        Ok(session)
    }

    fn make_action(&mut self) -> Result<(), String> {
        let table = &self.instance.table;
        let set = xr::ActionSetCreateInfo {
            ty: xr::ActionSetCreateInfo::TYPE,
            next: null(),
            action_set_name: fixed("htex"),
            localized_action_set_name: fixed("Textures"),
            priority: 0,
        };
        // SAFETY: the structure is laid out as the header declares it.
        let code =
            unsafe { (table.create_action_set)(self.instance.handle, &set, &mut self.action_set) };
        done("xrCreateActionSet", code)?;
        let action = xr::ActionCreateInfo {
            ty: xr::ActionCreateInfo::TYPE,
            next: null(),
            action_name: fixed("texture"),
            action_type: xr::ActionType::VIBRATION_OUTPUT,
            count_subaction_paths: self.hands.len() as u32,
            subaction_paths: self.hands.as_ptr(),
            localized_action_name: fixed("Texture"),
        };
        // SAFETY: the structure is laid out as the header declares it, and its paths last until the
        // call returns.
        let code = unsafe { (table.create_action)(self.action_set, &action, &mut self.action) };
        done("xrCreateAction", code)
    }

    /// Binds the action to all interaction profiles that the runtime accepts. The runtime must
    /// accept at least one profile.
    fn suggest(&self) -> Result<(), String> {
        let instance = &self.instance;
        let mut bindings = Vec::new();
        for hand in Hand::ALL {
            bindings.push(xr::ActionSuggestedBinding {
                action: self.action,
                binding: instance.path(hand.output())?,
            });
        }
        let mut last = Err("there is no profile".to_owned());
        for profile in PROFILES {
            let suggested = xr::InteractionProfileSuggestedBinding {
                ty: xr::InteractionProfileSuggestedBinding::TYPE,
                next: null(),
                interaction_profile: instance.path(profile)?,
                count_suggested_bindings: bindings.len() as u32,
                suggested_bindings: bindings.as_ptr(),
            };
            // SAFETY: the structure is laid out as the header declares it, and its bindings last
            // until the call returns.
            let code = unsafe { (instance.table.suggest_bindings)(instance.handle, &suggested) };
            let taken = done("xrSuggestInteractionProfileBindings", code);
            if last.is_err() {
                last = taken;
            }
        }
        last
    }

    fn attach(&self) -> Result<(), String> {
        let info = xr::SessionActionSetsAttachInfo {
            ty: xr::SessionActionSetsAttachInfo::TYPE,
            next: null(),
            count_action_sets: 1,
            action_sets: &self.action_set,
        };
        // SAFETY: the structure is laid out as the header declares it.
        let code = unsafe { (self.instance.table.attach_action_sets)(self.handle, &info) };
        done("xrAttachSessionActionSets", code)
    }

    fn wait_for_focus(&self) -> Result<(), String> {
        let since = Instant::now();
        while self.follow().is_err() {
            let state = self.state.lock().unwrap_or_else(PoisonError::into_inner).now;
            if is_over(state) || since.elapsed() > FOCUS {
                return Err(format!(
                    "its session does not get the focus (it is {state:?}); is a headset connected, and does another program have it?"
                ));
            }
            sleep(LOOK);
        }
        Ok(())
    }

    /// Polls the runtime's events and updates the bindings.
    ///
    /// # Errors
    /// Returns an error if the session does not have the focus.
    pub(crate) fn follow(&self) -> Result<(), String> {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        while let Some(now) = self.next_state()? {
            state.now = now;
            // The runtime refuses to begin a session that is already running.
            if now == xr::SessionState::READY && !state.begun {
                self.begin_session()?;
                state.begun = true;
            }
        }
        // Without the focus, the runtime makes all actions inactive, and haptics have no effect.
        if state.now != xr::SessionState::FOCUSED {
            return Err(format!("its session lost the focus (it is {:?})", state.now));
        }
        let active =
            xr::ActiveActionSet { action_set: self.action_set, subaction_path: xr::Path::NULL };
        let info = xr::ActionsSyncInfo {
            ty: xr::ActionsSyncInfo::TYPE,
            next: null(),
            count_active_action_sets: 1,
            active_action_sets: &active,
        };
        // SAFETY: the structure is laid out as the header declares it.
        let code = unsafe { (self.instance.table.sync_actions)(self.handle, &info) };
        done("xrSyncActions", code)
    }

    /// Returns the state in the next event of this session, or `None` if there is no event.
    fn next_state(&self) -> Result<Option<xr::SessionState>, String> {
        loop {
            let mut event = xr::EventDataBuffer {
                ty: xr::EventDataBuffer::TYPE,
                next: null(),
                varying: [0; 4000],
            };
            // SAFETY: a buffer of the header's size.
            let code =
                unsafe { (self.instance.table.poll_event)(self.instance.handle, &mut event) };
            if code == xr::Result::EVENT_UNAVAILABLE {
                return Ok(None);
            }
            done("xrPollEvent", code)?;
            if event.ty == xr::EventDataSessionStateChanged::TYPE {
                // SAFETY: an event of this type has the layout of this structure, and the buffer is
                // large enough and aligned for it.
                let changed =
                    unsafe { (&raw const event).cast::<xr::EventDataSessionStateChanged>().read() };
                return Ok(Some(changed.state));
            }
            if event.ty == xr::EventDataInstanceLossPending::TYPE {
                return Ok(Some(xr::SessionState::LOSS_PENDING));
            }
        }
    }

    fn begin_session(&self) -> Result<(), String> {
        let info = xr::SessionBeginInfo {
            ty: xr::SessionBeginInfo::TYPE,
            next: null(),
            primary_view_configuration_type: xr::ViewConfigurationType::PRIMARY_STEREO,
        };
        // SAFETY: the structure is laid out as the header declares it.
        let code = unsafe { (self.instance.table.begin_session)(self.handle, &info) };
        done("xrBeginSession", code)
    }

    fn element(&self, hand: Hand) -> xr::HapticActionInfo {
        xr::HapticActionInfo {
            ty: xr::HapticActionInfo::TYPE,
            next: null(),
            action: self.action,
            subaction_path: self.hands[hand as usize],
        }
    }

    /// Applies haptics to a hand.
    ///
    /// # Safety
    /// `haptics` begins with the header of a structure that an extension in use defines, with valid
    /// arrays.
    pub(crate) unsafe fn apply(
        &self,
        hand: Hand,
        haptics: *const xr::HapticBaseHeader,
    ) -> Result<(), String> {
        let element = self.element(hand);
        // SAFETY: guaranteed by the caller.
        let code = unsafe { (self.instance.table.apply)(self.handle, &element, haptics) };
        done("xrApplyHapticFeedback", code)
    }

    /// Stops a hand at once.
    pub(crate) fn stop(&self, hand: Hand) -> Result<(), String> {
        let element = self.element(hand);
        // SAFETY: the structure is laid out as the header declares it.
        let code = unsafe { (self.instance.table.stop)(self.handle, &element) };
        done("xrStopHapticFeedback", code)
    }

    /// Returns the properties of a hand's haptic element, if the system can play points.
    pub(crate) fn properties(&self, hand: Hand) -> Result<Properties, String> {
        let get = self.instance.table.parametric_properties;
        let (Some(get), true) = (get, self.instance.has_points) else {
            return Err("the runtime or its system has no XR_EXT_haptic_parametric".to_owned());
        };
        let element = self.element(hand);
        let mut properties = Properties {
            ty: PROPERTIES,
            next: std::ptr::null_mut(),
            ideal_frame: xr::Duration::NONE,
            least_first_frame: xr::Duration::NONE,
            min_frequency_hz: 0.0,
            max_frequency_hz: 0.0,
        };
        // SAFETY: the structures are laid out as the header and the registry declare them.
        let code = unsafe { get(self.handle, &element, &mut properties) };
        done("xrHapticParametricGetPropertiesEXT", code).map(|()| properties)
    }

    /// Returns the rate at which a hand plays samples, hertz.
    pub(crate) fn pcm_rate_hz(&self, hand: Hand) -> Result<f64, String> {
        let get = self.instance.table.pcm_rate;
        let (Some(get), true) = (get, self.instance.has_pcm) else {
            return Err("the runtime has no XR_FB_haptic_pcm".to_owned());
        };
        let element = self.element(hand);
        let mut state = xr::DevicePcmSampleRateStateFB {
            ty: xr::DevicePcmSampleRateStateFB::TYPE,
            next: std::ptr::null_mut(),
            sample_rate: 0.0,
        };
        // SAFETY: the structures are laid out as the header declares them.
        let code = unsafe { get(self.handle, &element, &mut state) };
        done("xrGetDeviceSampleRateFB", code)?;
        match f64::from(state.sample_rate) {
            rate_hz if rate_hz.is_finite() && rate_hz >= 1.0 => Ok(rate_hz),
            _ => Err(format!("the {} hand has no device that plays samples", hand.name())),
        }
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        // SAFETY: the session is not used afterwards; its action is destroyed with the instance.
        unsafe { (self.instance.table.destroy_session)(self.handle) };
    }
}

/// Whether a session in this state can no longer get the focus.
fn is_over(state: xr::SessionState) -> bool {
    [xr::SessionState::STOPPING, xr::SessionState::LOSS_PENDING, xr::SessionState::EXITING]
        .contains(&state)
}
