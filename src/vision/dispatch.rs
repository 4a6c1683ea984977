//! Choice among processors at run time.

/// Compiles a function for several generations of x86 and ARM processors, of which the best is chosen when it is
/// called, beside a portable version. Functions that it calls take part if they are inlined into it.
macro_rules! vectorised {
    ($function:item) => {
        #[multiversion::multiversion(targets(
            "x86_64+avx512f+avx512bw+avx512dq+avx512vl+avx512vbmi",
            "x86_64+avx2+bmi1+bmi2",
            "x86_64+ssse3+sse4.1",
        ))]
        $function
    };
}

pub(super) use vectorised;
