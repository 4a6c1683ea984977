//! How the time of each system grows with the size of its task, over two or three decades: a table with the
//! exponent of each curve.
//!
//! `cargo bench -p roverlab-bench --bench curves`; `-- --picture FILE` also draws the curves.

#[path = "curves/chart.rs"]
mod chart;
#[path = "curves/curve.rs"]
mod curve;
#[path = "curves/tasks.rs"]
mod tasks;

use std::error::Error;

use curve::Curve;

fn main() -> Result<(), Box<dyn Error>> {
    let picture = picture_file()?;
    println!("| system | per | times | exponent | at most between two |\n|---|---|---|---|---|");
    let mut curves = Vec::new();
    for measure in tasks::ALL {
        let curve = measure();
        println!("{}", row(&curve));
        curves.push(curve);
    }
    if let Some(file) = picture {
        chart::chart(&curves).save(file)?;
    }
    Ok(())
}

/// The file that the command line names.
fn picture_file() -> Result<Option<String>, String> {
    // Cargo itself adds a word.
    let words: Vec<String> = std::env::args().skip(1).filter(|word| word != "--bench").collect();
    match words.as_slice() {
        [] => Ok(None),
        [option, file] if option == "--picture" => Ok(Some(file.clone())),
        other => Err(format!("found {}; expected --picture FILE or nothing", other.join(" "))),
    }
}

/// A line of the table.
fn row(curve: &Curve) -> String {
    let times: Vec<String> = curve
        .points
        .iter()
        .map(|point| format!("{}: {}", curve::short(point.size), in_words(point.seconds)))
        .collect();
    let steps = curve.points.windows(2).map(curve::exponent).fold(f64::NEG_INFINITY, f64::max);
    let (name, unit) = (curve.name, curve.unit);
    format!("| {name} | {unit} | {} | {:.2} | {steps:.2} |", times.join(", "), curve::exponent(&curve.points))
}

fn in_words(seconds: f64) -> String {
    match seconds {
        s if s < 1e-3 => format!("{:.3} ms", 1e3 * s),
        s if s < 1.0 => format!("{:.1} ms", 1e3 * s),
        s => format!("{s:.2} s"),
    }
}
