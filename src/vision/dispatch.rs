//! Selection of the processor's instruction set at run time.

/// Compiles a function for several generations of x86-64 processors, besides a portable version; the best one
/// is chosen at each call. Functions that it calls take part only if they are inlined.
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

/// A vectorised function from one image to another that receives the bytes as separate slices. The compiler
/// knows that slices do not overlap; for views it would check that repeatedly.
macro_rules! vectorised_filter {
    (fn $name:ident($input:ident: $from:ty, $output:ident: &mut $to:ty $(, $argument:ident: $kind:ty)* $(,)?) $body:block) => {
        fn $name($input: $from, $output: &mut $to $(, $argument: $kind)*) {
            $crate::vision::dispatch::vectorised! {
                fn on_slices(
                    source: &[u8],
                    source_shape: $crate::vision::view::Shape,
                    target: &mut [u8],
                    target_shape: $crate::vision::view::Shape
                    $(, $argument: $kind)*
                ) {
                    let $input = <$from>::of(source, source_shape);
                    let $output = &mut <$to>::of(target, target_shape);
                    $body
                }
            }
            let (source, source_shape) = $input.parts();
            let (target, target_shape) = $output.parts();
            on_slices(source, source_shape, target, target_shape $(, $argument)*);
        }
    };
}

pub(super) use {vectorised, vectorised_filter};
