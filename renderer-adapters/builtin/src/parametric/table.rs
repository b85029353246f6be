//! The OpenXR functions that this adapter uses, taken from an OpenXR runtime or loader.
#![allow(unsafe_code)] // A loader: the library's functions are C.

use std::ffi::{CStr, CString};
use std::mem::{size_of, transmute_copy};

use htex_base::native::Library;
use htex_device::DeviceError;
use openxr_sys::{self as xr, pfn};

use crate::driver::DriverLibrary;
use crate::parametric::structures::GetProperties;

const LIBRARY: DriverLibrary = DriverLibrary {
    names: if cfg!(windows) {
        &["openxr_loader.dll"]
    } else if cfg!(target_os = "macos") {
        &["libopenxr_loader.dylib"]
    } else {
        &["libopenxr_loader.so.1", "libopenxr_loader.so"]
    },
    loaded_as: "an OpenXR runtime",
    setting: "runtime",
    absent: "no OpenXR loader is installed",
    remedy: "Install one (Debian, Ubuntu: `libopenxr-loader1`) and a runtime, or name a runtime's \
             library by the setting `runtime`",
};

/// The requested version of OpenXR: the first one, which all runtimes support.
pub(crate) const VERSION: xr::Version = xr::Version::new(1, 0, 0);

/// The type of the function that looks up all other functions.
pub(crate) type Entry = pfn::GetInstanceProcAddr;

/// Loads the entry function of the library at `path`, or of the installed loader if `path` is
/// empty.
pub(crate) fn entry(path: &str) -> Result<Entry, DeviceError> {
    LIBRARY.load(path, entry_of)
}

/// Finds the entry function. A runtime exports the negotiation function, and a loader exports the
/// entry function itself.
fn entry_of(library: Library) -> Result<Entry, String> {
    // SAFETY: `openxr_loader_negotiation.h` declares a function of this name and type.
    let negotiate = unsafe {
        library.symbol::<pfn::NegotiateLoaderRuntimeInterface>("xrNegotiateLoaderRuntimeInterface")
    };
    if let Some(negotiate) = negotiate {
        return negotiated(negotiate);
    }
    // SAFETY: `openxr.h` declares a function of this name and type.
    let entry = unsafe { library.symbol::<Entry>("xrGetInstanceProcAddr") };
    entry.ok_or_else(|| {
        "it has neither `xrNegotiateLoaderRuntimeInterface` nor `xrGetInstanceProcAddr`".to_owned()
    })
}

fn negotiated(negotiate: pfn::NegotiateLoaderRuntimeInterface) -> Result<Entry, String> {
    let version = xr::CURRENT_LOADER_RUNTIME_VERSION as u32;
    let info = xr::NegotiateLoaderInfo {
        struct_type: xr::NegotiateLoaderInfo::TYPE,
        struct_version: xr::NegotiateLoaderInfo::VERSION,
        struct_size: size_of::<xr::NegotiateLoaderInfo>(),
        min_interface_version: version,
        max_interface_version: version,
        min_api_version: VERSION,
        // Any minor version and patch of OpenXR 1.
        max_api_version: xr::Version::new(1, 0x3ff, 0xfff),
    };
    let mut request = xr::NegotiateRuntimeRequest {
        struct_type: xr::NegotiateRuntimeRequest::TYPE,
        struct_version: xr::NegotiateRuntimeRequest::VERSION,
        struct_size: size_of::<xr::NegotiateRuntimeRequest>(),
        runtime_interface_version: 0,
        runtime_api_version: xr::Version::default(),
        get_instance_proc_addr: None,
    };
    // SAFETY: both structures are laid out as the header declares them.
    done("xrNegotiateLoaderRuntimeInterface", unsafe { negotiate(&info, &mut request) })?;
    request.get_instance_proc_addr.ok_or_else(|| "it gives no `xrGetInstanceProcAddr`".to_owned())
}

/// Checks that a call succeeded. The error names the call and its result.
pub(crate) fn done(call: &str, code: xr::Result) -> Result<(), String> {
    match code {
        xr::Result::SUCCESS => Ok(()),
        _ => Err(format!("{call}: {code} ({})", code.into_raw())),
    }
}

/// Looks up the function of this name.
///
/// # Safety
/// `F` is the type that the header states for it.
pub(crate) unsafe fn function<F: Copy>(
    entry: Entry,
    instance: xr::Instance,
    name: &CStr,
) -> Result<F, String> {
    let mut found: Option<pfn::VoidFunction> = None;
    // SAFETY: the name ends in zero.
    let code = unsafe { entry(instance, name.as_ptr(), &mut found) };
    let name = name.to_string_lossy();
    done(&format!("xrGetInstanceProcAddr for {name}"), code)?;
    let found = found.ok_or_else(|| format!("the runtime has no {name}"))?;
    // SAFETY: both are pointers of functions, and the caller knows the type.
    Ok(unsafe { transmute_copy::<pfn::VoidFunction, F>(&found) })
}

macro_rules! table {
    ($($field:ident: $type:ident,)*) => {
        /// The functions of an instance.
        pub(crate) struct Table {
            $(pub(crate) $field: pfn::$type,)*
            /// `None` without the extension.
            pub(crate) parametric_properties: Option<GetProperties>,
            pub(crate) pcm_rate: Option<pfn::GetDeviceSampleRateFB>,
        }

        impl Table {
            pub(crate) fn from_entry(entry: Entry, instance: xr::Instance) -> Result<Self, String> {
                // SAFETY: the header declares functions of these names and types.
                unsafe {
                    Ok(Self {
                        $($field: {
                            let name = concat!("xr", stringify!($type));
                            let name = CString::new(name).unwrap_or_default();
                            function::<pfn::$type>(entry, instance, &name)?
                        },)*
                        parametric_properties: function(entry, instance, c"xrHapticParametricGetPropertiesEXT").ok(),
                        pcm_rate: function(entry, instance, c"xrGetDeviceSampleRateFB").ok(),
                    })
                }
            }
        }
    };
}

table! {
    destroy_instance: DestroyInstance,
    get_system: GetSystem,
    get_system_properties: GetSystemProperties,
    create_session: CreateSession,
    destroy_session: DestroySession,
    begin_session: BeginSession,
    poll_event: PollEvent,
    string_to_path: StringToPath,
    create_action_set: CreateActionSet,
    create_action: CreateAction,
    suggest_bindings: SuggestInteractionProfileBindings,
    attach_action_sets: AttachSessionActionSets,
    sync_actions: SyncActions,
    apply: ApplyHapticFeedback,
    stop: StopHapticFeedback,
}
