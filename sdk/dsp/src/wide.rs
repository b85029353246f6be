//! The processor's wider registers, where it has them.

/// Something to do in registers as wide as there are; `run` is always inlined.
pub(crate) trait Work {
    fn run(self);
}

/// Does some work, compiled for registers of 256 bits where the processor has them. The same operations
/// in the same order, several numbers at a time: the same bits, sooner.
#[cfg(all(feature = "std", target_arch = "x86_64"))]
#[inline]
#[allow(unsafe_code)]
pub(crate) fn wide(work: impl Work) {
    #[target_feature(enable = "avx2")]
    fn with_avx2(work: impl Work) {
        work.run();
    }
    if std::is_x86_feature_detected!("avx2") {
        // SAFETY: the processor was just asked.
        return unsafe { with_avx2(work) };
    }
    work.run();
}

/// Does some work.
#[cfg(not(all(feature = "std", target_arch = "x86_64")))]
#[inline(always)]
pub(crate) fn wide(work: impl Work) {
    work.run();
}
