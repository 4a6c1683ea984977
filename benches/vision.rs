//! Every kernel of `roverlab::vision` at three resolutions, beside imageproc's and beside a copy of the
//! memory.
//!
//! `cargo bench -p roverlab-bench --bench vision` prints the table. `-- --json FILE` writes the times as
//! JSON, `-- --images FOLDER` the images that they were taken on, for `benches/peers/vision.py`; `-- --quick`
//! measures for a shorter time.

#[path = "vision/clock.rs"]
mod clock;
#[path = "vision/kernels.rs"]
mod kernels;
#[path = "vision/scene.rs"]
mod scene;

use std::fmt::Write as _;
use std::path::PathBuf;

use clock::Effort;
use kernels::{Sample, measure};

/// Columns and rows.
const SIZES: [(u32, u32); 3] = [(320, 240), (640, 480), (1920, 1080)];

#[derive(Debug, Default)]
struct Options {
    json: Option<PathBuf>,
    images: Option<PathBuf>,
    quick: bool,
}

fn options() -> Result<Options, String> {
    let mut options = Options::default();
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut file = || words.next().map(PathBuf::from).ok_or(format!("{word}: expected a file"));
        match word.as_str() {
            "--json" => options.json = Some(file()?),
            "--images" => options.images = Some(file()?),
            "--quick" => options.quick = true,
            // What cargo itself adds.
            "--bench" => {}
            other => return Err(format!("found {other}; expected --json FILE, --images FOLDER or --quick")),
        }
    }
    Ok(options)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let options = options()?;
    let effort = if options.quick { Effort::Quick } else { Effort::Full };
    let mut samples = Vec::new();
    for size in SIZES {
        let pair = scene::images(size)?;
        if let Some(folder) = &options.images {
            std::fs::create_dir_all(folder)?;
            for (name, image) in [("first", &pair.first), ("second", &pair.second)] {
                image.save(folder.join(format!("{name}_{}x{}.png", size.0, size.1)))?;
            }
        }
        samples.extend(measure(&pair, effort)?);
    }
    if let Some(file) = &options.json {
        std::fs::write(file, json(&samples))?;
    }
    print!("{}", table(&samples));
    Ok(())
}

/// One line for each kernel and resolution.
fn table(samples: &[Sample]) -> String {
    let mut text = String::from(
        "One thread, medians. GB/s counts the bytes read and written once; a copy moves as many.\n\n\
         | kernel | resolution | us | ns/pixel | GB/s | times imageproc's speed | times a copy's time |\n\
         |---|---|---|---|---|---|---|\n",
    );
    for sample in samples {
        let Sample { kernel, size, seconds, bytes, .. } = sample;
        let pixels = f64::from(size.0) * f64::from(size.1);
        let imageproc = sample.imageproc.map_or("-".to_owned(), |peer| format!("{:.1}", peer / seconds));
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "| {kernel} | {}x{} | {:.1} | {:.3} | {:.1} | {imageproc} | {:.1} |",
            size.0,
            size.1,
            1e6 * seconds,
            1e9 * seconds / pixels,
            *bytes as f64 / seconds / 1e9,
            seconds / sample.copy,
        );
    }
    text
}

/// A list of `{"kernel", "width", "height", "microseconds", "imageproc", "copy"}`.
fn json(samples: &[Sample]) -> String {
    let rows: Vec<String> = samples
        .iter()
        .map(|sample| {
            let peer = sample.imageproc.map_or("null".to_owned(), |seconds| format!("{:.3}", 1e6 * seconds));
            format!(
                "{{\"kernel\": \"{}\", \"width\": {}, \"height\": {}, \"microseconds\": {:.3}, \"imageproc\": {peer}, \"copy\": {:.3}}}",
                sample.kernel,
                sample.size.0,
                sample.size.1,
                1e6 * sample.seconds,
                1e6 * sample.copy
            )
        })
        .collect();
    format!("[\n{}\n]\n", rows.join(",\n"))
}
