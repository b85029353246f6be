//! The parts of the board that the program uses: reset, semihosting and the timer.

use core::arch::asm;
use core::fmt;
use core::panic::PanicInfo;
use core::ptr::{read_volatile, write_volatile};

/// The register that grants access to coprocessors. The floating-point unit is two of them.
const CPACR: *mut u32 = 0xE000_ED88 as *mut u32;
const SYST_CSR: *mut u32 = 0xE000_E010 as *mut u32;
const SYST_RVR: *mut u32 = 0xE000_E014 as *mut u32;
const SYST_CVR: *mut u32 = 0xE000_E018 as *mut u32;
/// The timer counts down from its largest value.
const RELOAD: u32 = 0x00FF_FFFF;
/// Instructions per tick of the timer: with `-icount shift=0` an instruction takes 1 ns, and the
/// timer runs at 25 MHz.
const IN_TICK: u32 = 40;

unsafe extern "C" {
    static stack_top: u32;
}

#[repr(C)]
union Vector {
    address: *const u32,
    handler: unsafe extern "C" fn() -> !,
}

// SAFETY: The table is constant.
unsafe impl Sync for Vector {}

#[unsafe(link_section = ".vectors")]
#[used]
static VECTORS: [Vector; 16] = {
    const FAULT: Vector = Vector { handler: fault };
    let mut vectors = [FAULT; 16];
    vectors[0] = Vector { address: &raw const stack_top };
    vectors[1] = Vector { handler: reset };
    vectors
};

/// The first instructions after reset. They run before any instruction that uses floating-point
/// registers.
#[unsafe(no_mangle)]
unsafe extern "C" fn reset() -> ! {
    // SAFETY: The register exists on every Cortex-M4, and nothing else runs.
    unsafe {
        write_volatile(CPACR, read_volatile(CPACR) | 0xF << 20);
        asm!("dsb", "isb");
    }
    start()
}

#[inline(never)]
fn start() -> ! {
    crate::main()
}

unsafe extern "C" fn fault() -> ! {
    print("error: a fault of the processor\n");
    exit()
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    print("error: a panic\n");
    exit()
}

/// Calls the debugger, which is QEMU.
fn semihosting(operation: u32, argument: u32) {
    // SAFETY: With semihosting the breakpoint returns, and changes only r0.
    unsafe { asm!("bkpt 0xAB", inout("r0") operation => _, in("r1") argument) };
}

fn print(text: &str) {
    for byte in text.as_bytes() {
        // SYS_WRITEC writes the character at an address.
        semihosting(0x03, core::ptr::from_ref(byte) as u32);
    }
}

/// Ends QEMU.
pub(crate) fn exit() -> ! {
    loop {
        // SYS_EXIT with ADP_Stopped_ApplicationExit.
        semihosting(0x18, 0x20026);
    }
}

/// The standard output of QEMU.
pub(crate) struct Console;

impl fmt::Write for Console {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        print(text);
        Ok(())
    }
}

/// Counts instructions, in steps of 40, if QEMU runs with `-icount shift=0`.
pub(crate) struct Timer;

impl Timer {
    pub(crate) fn start() -> Self {
        // SAFETY: The registers exist on every Cortex-M4, and nothing else uses them.
        unsafe {
            write_volatile(SYST_RVR, RELOAD);
            write_volatile(SYST_CVR, 0);
            write_volatile(SYST_CSR, 0b101);
        }
        Self
    }

    pub(crate) fn instructions(self) -> u32 {
        // SAFETY: As in `start`.
        let now = unsafe { read_volatile(SYST_CVR) };
        (RELOAD - now) * IN_TICK
    }
}
