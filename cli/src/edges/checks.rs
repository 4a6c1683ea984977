//! Contradictory options, and errors of the kernels in terms of the command line.

use roverlab::vision::ImageError;

use super::{Args, Definition, Kernel};
use crate::common::Failure;

/// Fails for contradictory options.
pub(crate) fn check(args: &Args) -> Result<(), Failure> {
    let kernel = args.kernel.name();
    if args.kernel.thresholds_shades()
        && let Some(found) = args.threshold.filter(|&threshold| threshold > 255)
    {
        return Err(Failure::input(format!(
            "--threshold: found {found}; expected 0 to 255 for --kernel {kernel}"
        )));
    }
    let colours = args.kernel.works_on_colours()
        || args.kernel == Kernel::Blobs && !args.binary
        || args.kernel == Kernel::Overlay && args.second.is_some();
    if colours && args.smooth.is_some_and(|size| size > 0) {
        return Err(Failure::input(format!(
            "--smooth: found --kernel {kernel}, which works on colours; expected one that works on shades of gray"
        )));
    }
    if args.exact && args.definition == Definition::OpenCv {
        return Err(Failure::input(
            "--exact: found --definition opencv; expected book, whose formulas it asks for",
        ));
    }
    if args.input.is_some() {
        args.common.check_placeless("an image from --input was taken by no robot")?;
    } else if let Some(picture) = &args.common.picture {
        let picture = picture.display();
        return Err(Failure::input(format!(
            "--picture {picture}: found none of a run; expected --output FILE"
        )));
    }
    Ok(())
}

/// A kernel's error with the option that caused it.
pub(crate) fn refused(error: &ImageError) -> Failure {
    let option = match error {
        ImageError::Parameter(error) => option_of(error.name()),
        ImageError::Size { what: "second image", .. } => Some("--second"),
        _ => None,
    };
    match option {
        Some(option) => Failure::input(format!("{option}: {error}")),
        None => Failure::input(format!("--kernel: {error}")),
    }
}

/// The option that sets a parameter.
fn option_of(parameter: &str) -> Option<&'static str> {
    Some(match parameter {
        "low threshold" => "--low",
        "step of rho" => "--rho",
        "hue" => "--hue",
        "low hue" => "--hue-low",
        "high hue" => "--hue-high",
        "Gaussian sigma" => "--sigma",
        _ => return None,
    })
}
