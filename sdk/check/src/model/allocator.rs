//! Counts the calls that loaded libraries make to the C library's allocator.
//!
//! The dynamic linker writes the addresses of `malloc` and related functions into a table of each
//! loaded library (its relocations by symbol). [`AllocatorCalls::watch`] replaces these addresses
//! with the addresses of functions that count each call and then call the allocator. It replaces
//! them in every library of the process, including the C library and the C++ runtime. So
//! allocations by `new`, by `strdup` and by the `Vec` of a Rust library are also counted. Each
//! thread has its own count. The table of the program itself is not changed, so the host's own
//! allocations are not counted.
//!
//! This method does not detect two kinds of calls. The first are calls to an allocator that is
//! linked statically into a library and maps pages itself. The second are calls to an address that
//! `dlsym` returned. This method also does not detect calls in libraries that are loaded after
//! `watch`, or in threads that a library starts.
//!
//! Other methods have disadvantages. Comparing the heap before and after does not show memory that
//! was allocated and freed in between. If the program defined its own `malloc`, all other commands
//! of the program would use it. A preloaded library would be a second file to install. In a WASM
//! module, the checker detects only that the module's memory grows.
#![allow(unsafe_code)] // The dynamic linker's tables are C.

use std::cell::Cell;
use std::ffi::{CStr, c_char, c_int, c_void};

use libc::{dl_phdr_info, size_t};

thread_local! {
    // The initial value is a constant without a destructor, because lazy initialisation would
    // allocate.
    static CALLS: Cell<u64> = const { Cell::new(0) };
}

/// Libraries whose allocator calls are counted, for the rest of the process.
pub(crate) struct AllocatorCalls {
    places: usize,
}

impl AllocatorCalls {
    /// Starts counting the calls of all libraries that are loaded now.
    pub(crate) fn watch() -> Self {
        let mut places = 0usize;
        // SAFETY: `visit` has the required type, and gets the address of `places`, which outlives
        // the call.
        unsafe { libc::dl_iterate_phdr(Some(visit), (&raw mut places).cast()) };
        Self { places }
    }

    /// Returns the number of replaced table entries. It is 0 if no library calls the C library's
    /// allocator.
    pub(crate) fn places(&self) -> usize {
        self.places
    }

    /// Counts the allocations and frees that `run` makes in this thread through libraries.
    pub(crate) fn during<T>(&self, run: impl FnOnce() -> T) -> (T, u64) {
        let before = CALLS.get();
        let out = run();
        (out, CALLS.get() - before)
    }
}

fn count() {
    CALLS.set(CALLS.get() + 1);
}

unsafe extern "C" fn malloc(size: size_t) -> *mut c_void {
    count();
    // The table of this program is not replaced, so this is the real function.
    // SAFETY: the arguments are passed on unchanged.
    unsafe { libc::malloc(size) }
}

unsafe extern "C" fn calloc(items: size_t, size: size_t) -> *mut c_void {
    count();
    // SAFETY: the arguments are passed on unchanged.
    unsafe { libc::calloc(items, size) }
}

unsafe extern "C" fn realloc(pointer: *mut c_void, size: size_t) -> *mut c_void {
    count();
    // SAFETY: the arguments are passed on unchanged.
    unsafe { libc::realloc(pointer, size) }
}

unsafe extern "C" fn aligned_alloc(alignment: size_t, size: size_t) -> *mut c_void {
    count();
    // SAFETY: the arguments are passed on unchanged.
    unsafe { libc::aligned_alloc(alignment, size) }
}

unsafe extern "C" fn posix_memalign(
    out: *mut *mut c_void,
    alignment: size_t,
    size: size_t,
) -> c_int {
    count();
    // SAFETY: the arguments are passed on unchanged.
    unsafe { libc::posix_memalign(out, alignment, size) }
}

unsafe extern "C" fn free(pointer: *mut c_void) {
    count();
    // SAFETY: the arguments are passed on unchanged.
    unsafe { libc::free(pointer) }
}

/// Returns the counting function that replaces an allocator symbol.
fn counting(symbol: &CStr) -> Option<usize> {
    Some(match symbol.to_bytes() {
        b"malloc" => malloc as *const () as usize,
        b"calloc" => calloc as *const () as usize,
        b"realloc" => realloc as *const () as usize,
        b"aligned_alloc" => aligned_alloc as *const () as usize,
        b"posix_memalign" => posix_memalign as *const () as usize,
        b"free" => free as *const () as usize,
        _ => return None,
    })
}

/// An entry of the dynamic section (`Elf64_Dyn`).
#[repr(C)]
struct Dynamic {
    tag: i64,
    value: usize,
}

const DT_NULL: i64 = 0;
const DT_PLTRELSZ: i64 = 2;
const DT_STRTAB: i64 = 5;
const DT_SYMTAB: i64 = 6;
const DT_RELA: i64 = 7;
const DT_RELASZ: i64 = 8;
const DT_PLTREL: i64 = 20;
const DT_JMPREL: i64 = 23;

/// A relocation (`Elf64_Rela`).
#[repr(C)]
struct Relocation {
    offset: usize,
    info: u64,
    addend: i64,
}

/// The relocations of a library's dynamic section.
struct Library {
    base: usize,
    dynamic: *const Dynamic,
}

/// Replaces the addresses in one library, and adds their number to `places`.
unsafe extern "C" fn visit(info: *mut dl_phdr_info, _: size_t, places: *mut c_void) -> c_int {
    // SAFETY: the dynamic linker passes a description that lives during the call, and `watch`
    // passes the address of a number.
    let (info, places) = unsafe { (&*info, &mut *places.cast::<usize>()) };
    // SAFETY: a name is a string, or null.
    let name = (!info.dlpi_name.is_null())
        .then(|| unsafe { CStr::from_ptr(info.dlpi_name) })
        .map(CStr::to_bytes)
        .unwrap_or_default();
    // The program has no name. The kernel's own library cannot be written to and allocates nothing.
    if name.is_empty() || name.starts_with(b"linux-") {
        return 0;
    }
    // SAFETY: the description states the number of headers.
    let headers =
        unsafe { std::slice::from_raw_parts(info.dlpi_phdr, usize::from(info.dlpi_phnum)) };
    if let Some(header) = headers.iter().find(|h| h.p_type == libc::PT_DYNAMIC) {
        let base = info.dlpi_addr as usize;
        let library = Library { base, dynamic: (base + header.p_vaddr as usize) as *const Dynamic };
        *places += library.replace();
    }
    0
}

impl Library {
    /// Returns the value of an entry of the dynamic section; 0 if there is none.
    fn value(&self, tag: i64) -> usize {
        let mut at = self.dynamic;
        loop {
            // SAFETY: the section ends with DT_NULL, and nothing after it is read.
            let entry = unsafe { &*at };
            match entry.tag {
                DT_NULL => return 0,
                found if found == tag => return entry.value,
                // SAFETY: the entry was not the last one.
                _ => at = unsafe { at.add(1) },
            }
        }
    }

    /// Returns an address of the dynamic section. The GNU linker has already added the base
    /// address; other linkers have not.
    fn address(&self, tag: i64) -> usize {
        match self.value(tag) {
            0 => 0,
            address if address < self.base => address + self.base,
            address => address,
        }
    }

    /// Replaces all entries that hold the address of an allocator function and returns their
    /// number.
    fn replace(&self) -> usize {
        let mut replaced = 0;
        for relocation in self.relocations(DT_RELA, DT_RELASZ) {
            replaced += usize::from(self.replace_one(relocation));
        }
        // Tables without addends (DT_REL) exist only on 32-bit machines.
        if self.value(DT_PLTREL) == DT_RELA as usize {
            for relocation in self.relocations(DT_JMPREL, DT_PLTRELSZ) {
                replaced += usize::from(self.replace_one(relocation));
            }
        }
        replaced
    }

    fn relocations(&self, table: i64, bytes: i64) -> &[Relocation] {
        let (table, bytes) = (self.address(table), self.value(bytes));
        if table == 0 {
            return &[];
        }
        // SAFETY: the dynamic linker has applied this table, so it exists with the stated length.
        unsafe {
            std::slice::from_raw_parts(table as *const Relocation, bytes / size_of::<Relocation>())
        }
    }

    fn replace_one(&self, relocation: &Relocation) -> bool {
        let symbol = (relocation.info >> 32) as usize;
        // Skips relocations without a symbol, which are relative, and relocations with an addend,
        // because the address of a function has none.
        if symbol == 0 || relocation.addend != 0 {
            return false;
        }
        let Some(counting) = counting(self.name(symbol)) else {
            return false;
        };
        let place = (self.base + relocation.offset) as *mut usize;
        // The linker makes the table read-only after filling it.
        let page = place as usize & !(page_bytes() - 1);
        // SAFETY: the pages contain this word, which is data of the library, and writing to them is
        // allowed by `mprotect`.
        unsafe {
            let writable = libc::PROT_READ | libc::PROT_WRITE;
            if libc::mprotect(page as *mut c_void, page_bytes(), writable) != 0 {
                return false;
            }
            place.write_volatile(counting);
        }
        true
    }

    /// Returns the name of a symbol in the dynamic symbol table.
    fn name(&self, symbol: usize) -> &CStr {
        let (symbols, strings) = (self.address(DT_SYMTAB), self.address(DT_STRTAB));
        // SAFETY: relocations refer to entries of the symbol table, and the names of these symbols
        // are in the string table.
        unsafe {
            let symbol = &*(symbols as *const libc::Elf64_Sym).add(symbol);
            CStr::from_ptr((strings + symbol.st_name as usize) as *const c_char)
        }
    }
}

fn page_bytes() -> usize {
    // SAFETY: the call only returns a number.
    usize::try_from(unsafe { libc::sysconf(libc::_SC_PAGESIZE) }).unwrap_or(4096)
}
