//! `libhtex_player.a`: the functions of `include/htex_player.h`, for a host with an operating system or without one.
#![no_std]

// On a host the standard library brings the panic handler.
#[cfg(not(target_os = "none"))]
extern crate std;

pub use htex_player::*;

/// The player has no reachable panic; the language requires a handler.
#[cfg(target_os = "none")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}
