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

/// Does some work in registers of 512 bits where the processor has them, else gives it back: work of
/// that width is better done in two halves then.
#[cfg(all(feature = "std", target_arch = "x86_64"))]
#[inline]
#[allow(unsafe_code)]
pub(crate) fn very_wide<W: Work>(work: W) -> Result<(), W> {
    #[target_feature(enable = "avx512f,avx512vl,avx512bw,avx512dq")]
    fn with_avx512(work: impl Work) {
        work.run();
    }
    let there = std::is_x86_feature_detected!("avx512f")
        && std::is_x86_feature_detected!("avx512vl")
        && std::is_x86_feature_detected!("avx512bw")
        && std::is_x86_feature_detected!("avx512dq");
    if !there {
        return Err(work);
    }
    // SAFETY: the processor was just asked.
    unsafe { with_avx512(work) };
    Ok(())
}

/// Gives the work back.
#[cfg(not(all(feature = "std", target_arch = "x86_64")))]
#[inline(always)]
pub(crate) fn very_wide<W: Work>(work: W) -> Result<(), W> {
    Err(work)
}
