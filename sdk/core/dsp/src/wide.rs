//! Selects AVX2 and AVX-512 code on x86-64 at run time.
//!
//! Inner loops are compiled for registers of 128 and 256 bits, and the loops that generate noise
//! also for 512 bits. The operations and their order are the same in all versions, so the results
//! are bit-identical. The calls to these versions are the only unsafe code of this crate.

/// A computation that is compiled for several register widths; `run` is always inlined.
pub(crate) trait Work {
    fn run(self);
}

/// Runs the version of `work` that was compiled for AVX2 (256-bit registers) if the processor has
/// AVX2, otherwise the version for the target. The result is bit-identical, because the operations
/// and their order are the same.
#[cfg(all(feature = "std", target_arch = "x86_64"))]
#[inline]
#[allow(unsafe_code)]
pub(crate) fn wide(work: impl Work) {
    // Wider registers alone do not change the rounding, because Rust never fuses a product with a
    // sum on its own.
    #[target_feature(enable = "avx2")]
    fn with_avx2(work: impl Work) {
        work.run();
    }
    if std::is_x86_feature_detected!("avx2") {
        // SAFETY: AVX2 was detected above.
        return unsafe { with_avx2(work) };
    }
    work.run();
}

/// Runs `work`. Other targets have only one version.
#[cfg(not(all(feature = "std", target_arch = "x86_64")))]
#[inline(always)]
pub(crate) fn wide(work: impl Work) {
    work.run();
}

/// Runs the version of `work` that was compiled for AVX-512 (512-bit registers) if the processor
/// has AVX-512. Otherwise returns `work`. The caller then does the work in two halves, which is
/// faster on other processors.
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
    // SAFETY: all four features were detected above.
    unsafe { with_avx512(work) };
    Ok(())
}

/// Returns the work, because other targets have no 512-bit version.
#[cfg(not(all(feature = "std", target_arch = "x86_64")))]
#[inline(always)]
pub(crate) fn very_wide<W: Work>(work: W) -> Result<(), W> {
    Err(work)
}
