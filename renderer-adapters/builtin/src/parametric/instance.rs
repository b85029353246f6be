//! An OpenXR instance without graphics.
#![allow(unsafe_code)] // The runtime's functions are C.

use std::ffi::{CStr, c_char};
use std::ptr::{null, null_mut};

use openxr_sys::{self as xr, Handle as _, pfn};

use crate::parametric::structures::{NAME as PARAMETRIC, SYSTEM_PROPERTIES, SystemProperties};
use crate::parametric::table::{Entry, Table, VERSION, done, function};

/// Names of extensions.
const HEADLESS: &CStr = c"XR_MND_headless";
const PCM: &CStr = c"XR_FB_haptic_pcm";

/// An OpenXR instance and its system. Dropping it destroys both, and everything created from them.
pub(crate) struct Instance {
    pub(crate) table: Table,
    pub(crate) handle: xr::Instance,
    pub(crate) system: xr::SystemId,
    /// Whether the system can play points (`XR_EXT_haptic_parametric`).
    pub(crate) has_points: bool,
    /// Whether the runtime can play samples (`XR_FB_haptic_pcm`).
    pub(crate) has_pcm: bool,
}

impl Instance {
    pub(crate) fn create(entry: Entry) -> Result<Self, String> {
        let there = extensions(entry)?;
        if !there.iter().any(|name| name == HEADLESS.to_string_lossy().as_ref()) {
            return Err(
                "it does not run without graphics: it has no XR_MND_headless. A program with a session of its own reduces the samples by \
                 `htex_dsp::reduced` and hands the points over itself"
                    .to_owned(),
            );
        }
        let has = |name: &CStr| there.iter().any(|other| other.as_bytes() == name.to_bytes());
        let names: Vec<&CStr> =
            [HEADLESS, PARAMETRIC, PCM].into_iter().filter(|name| has(name)).collect();
        let handle = create(entry, &names)?;
        let table = match Table::from_entry(entry, handle) {
            Ok(table) => table,
            Err(error) => {
                // SAFETY: the handle belongs to this instance, and nothing else holds it.
                if let Ok(destroy) =
                    unsafe { function::<pfn::DestroyInstance>(entry, handle, c"xrDestroyInstance") }
                {
                    // SAFETY: as above.
                    unsafe { destroy(handle) };
                }
                return Err(error);
            }
        };
        let mut instance = Self {
            table,
            handle,
            system: xr::SystemId::NULL,
            has_points: false,
            has_pcm: has(PCM),
        };
        instance.find_system(has(PARAMETRIC))?;
        Ok(instance)
    }

    fn find_system(&mut self, has_parametric: bool) -> Result<(), String> {
        let info = xr::SystemGetInfo {
            ty: xr::SystemGetInfo::TYPE,
            next: null(),
            form_factor: xr::FormFactor::HEAD_MOUNTED_DISPLAY,
        };
        // SAFETY: the structure is laid out as the header declares it.
        let code = unsafe { (self.table.get_system)(self.handle, &info, &mut self.system) };
        done("xrGetSystem", code)?;
        if !has_parametric {
            return Ok(());
        }
        let mut parametric =
            SystemProperties { ty: SYSTEM_PROPERTIES, next: null_mut(), is_supported: xr::FALSE };
        let mut properties = xr::SystemProperties::out((&raw mut parametric).cast());
        // SAFETY: the runtime writes into a chain of two structures, which are laid out as the
        // registry defines them.
        let code = unsafe {
            (self.table.get_system_properties)(self.handle, self.system, properties.as_mut_ptr())
        };
        done("xrGetSystemProperties", code)?;
        self.has_points = parametric.is_supported.into();
        Ok(())
    }

    /// Converts a text such as `/user/hand/left` to an OpenXR path.
    pub(crate) fn path(&self, text: &CStr) -> Result<xr::Path, String> {
        let mut path = xr::Path::NULL;
        // SAFETY: the text ends in zero.
        let code = unsafe { (self.table.string_to_path)(self.handle, text.as_ptr(), &mut path) };
        done("xrStringToPath", code).map(|()| path)
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        // SAFETY: the instance is not used afterwards.
        unsafe { (self.table.destroy_instance)(self.handle) };
    }
}

/// Lists the extensions of the runtime.
fn extensions(entry: Entry) -> Result<Vec<String>, String> {
    let call = "xrEnumerateInstanceExtensionProperties";
    // SAFETY: the header declares a function of this name and type.
    let enumerate = unsafe {
        function::<pfn::EnumerateInstanceExtensionProperties>(
            entry,
            xr::Instance::NULL,
            c"xrEnumerateInstanceExtensionProperties",
        )
    }?;
    let mut count = 0;
    // SAFETY: the array has no elements, so the call writes only the count.
    done(call, unsafe { enumerate(null(), 0, &mut count, null_mut()) })?;
    let empty = xr::ExtensionProperties {
        ty: xr::ExtensionProperties::TYPE,
        next: null_mut(),
        extension_name: [0; xr::MAX_EXTENSION_NAME_SIZE],
        extension_version: 0,
    };
    let mut all = vec![empty; count as usize];
    // SAFETY: the array has as many elements as the call states.
    done(call, unsafe { enumerate(null(), count, &mut count, all.as_mut_ptr()) })?;
    // The runtime may write fewer extensions than it announced.
    all.truncate(count as usize);
    let name = |one: &xr::ExtensionProperties| {
        let bytes = one.extension_name.iter().take_while(|c| **c != 0);
        let bytes: Vec<u8> = bytes.map(|c| *c as u8).collect();
        String::from_utf8_lossy(&bytes).into_owned()
    };
    Ok(all.iter().map(name).collect())
}

fn create(entry: Entry, extensions: &[&CStr]) -> Result<xr::Instance, String> {
    // SAFETY: the header declares a function of this name and type.
    let create =
        unsafe { function::<pfn::CreateInstance>(entry, xr::Instance::NULL, c"xrCreateInstance") }?;
    let names: Vec<*const c_char> = extensions.iter().map(|name| name.as_ptr()).collect();
    let info = xr::InstanceCreateInfo {
        ty: xr::InstanceCreateInfo::TYPE,
        next: null(),
        create_flags: xr::InstanceCreateFlags::EMPTY,
        application_info: xr::ApplicationInfo {
            application_name: fixed("htex"),
            application_version: 1,
            engine_name: fixed("htex"),
            engine_version: 1,
            api_version: VERSION,
        },
        enabled_api_layer_count: 0,
        enabled_api_layer_names: null(),
        enabled_extension_count: names.len() as u32,
        enabled_extension_names: names.as_ptr(),
    };
    let mut instance = xr::Instance::NULL;
    // SAFETY: the structure and its texts last until the call returns.
    done("xrCreateInstance", unsafe { create(&info, &mut instance) })?;
    Ok(instance)
}

/// Copies a short text into an array of fixed size, and fills the rest with zeros.
pub(crate) fn fixed<const N: usize>(text: &str) -> [c_char; N] {
    let mut place = [0; N];
    for (to, byte) in place.iter_mut().take(N - 1).zip(text.bytes()) {
        *to = byte as c_char;
    }
    place
}
