//! Arrays that are followed by guard values and, on 64-bit Linux, by a protected page. With these
//! arrays, the checker detects a call that reads or writes beyond an array, and names this call.

use crate::harness::Finding;

#[cfg(all(target_os = "linux", target_pointer_width = "64"))]
use crate::model::pages::Pages;
#[cfg(not(all(target_os = "linux", target_pointer_width = "64")))]
use crate::model::vector::Pages;

/// Number of guard values on both sides of an output.
const GUARDS: usize = 16;

/// A number in an array, with the value of its guards.
pub(crate) trait Number: Copy + PartialEq + Default + Send + 'static {
    const GUARD: Self;
}

impl Number for u8 {
    const GUARD: Self = 0xA5;
}

impl Number for f32 {
    const GUARD: Self = -1234.5;
}

impl Number for f64 {
    const GUARD: Self = -1234.5;
}

/// An array that a call may read or write.
pub(crate) struct Fenced<T> {
    pages: Pages<T>,
    guards: usize,
    len: usize,
    /// The call that gets the array.
    call: &'static str,
    /// The argument that limits the array's length.
    bound: &'static str,
}

impl<T: Number> Fenced<T> {
    /// Creates an array that a call reads. The protected page is directly behind it.
    pub(crate) fn input(values: &[T], call: &'static str, array: &'static str) -> Self {
        let mut fenced = Self::new(values.len(), 0, "read or wrote", (call, array));
        fenced.get().copy_from_slice(values);
        fenced
    }

    /// Creates an array to which a call writes at most `len` values. The guards are between the
    /// array and the protected page.
    pub(crate) fn output(len: usize, call: &'static str, bound: &'static str) -> Self {
        let mut fenced = Self::new(len, GUARDS, "wrote", (call, bound));
        fenced.pages.get().fill(T::GUARD);
        fenced
    }

    fn new(
        len: usize,
        guards: usize,
        did: &str,
        (call, bound): (&'static str, &'static str),
    ) -> Self {
        let finding = Finding::failed(format!("`{call}` {did} beyond `{bound}`, which was {len}"));
        Self { pages: Pages::new(len + 2 * guards, finding), guards, len, call, bound }
    }

    pub(crate) fn get(&mut self) -> &mut [T] {
        let (guards, len) = (self.guards, self.len);
        &mut self.pages.get()[guards..guards + len]
    }

    /// Fails if a call wrote to the guards.
    pub(crate) fn check(&mut self) -> Result<(), Finding> {
        let (guards, len, call, bound) = (self.guards, self.len, self.call, self.bound);
        let all = self.pages.get();
        let written = |part: &[T]| part.iter().filter(|x| **x != T::GUARD).count();
        let (before, behind) = (written(&all[..guards]), written(&all[guards + len..]));
        match (before, behind) {
            (0, 0) => Ok(()),
            (0, _) => {
                Err(Finding::failed(format!("`{call}` wrote beyond `{bound}`, which was {len}")))
            }
            _ => Err(Finding::failed(format!(
                "`{call}` wrote in front of the array that `{bound}` bounds"
            ))),
        }
    }

    /// Fails if a call wrote to an array that it may only read.
    pub(crate) fn unchanged(&mut self, values: &[T], array: &str) -> Result<(), Finding> {
        let call = self.call;
        if self.get() == values {
            Ok(())
        } else {
            Err(Finding::failed(format!("`{call}` wrote to `{array}`, which it may only read")))
        }
    }
}

/// Starts watching: from now on, a call that reads or writes a fence ends this process with a
/// finding.
pub(crate) fn watch() {
    #[cfg(all(target_os = "linux", target_pointer_width = "64"))]
    crate::model::pages::watch();
}
