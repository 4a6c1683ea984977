//! Runs a network of a file on inputs from standard input, 32-bit numbers one after the other, and prints its
//! results, a line for each; to standard error, the median time of a run in milliseconds.
//! `tests/interop/network.py` compares them.

use std::io::Read;
use std::time::Instant;

use roverlab::vision::network::Network;

/// Runs whose time is taken.
const RUNS: usize = 200;

#[allow(clippy::disallowed_methods, reason = "it takes the time")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = std::env::args().nth(1).ok_or("expected a file of weights")?;
    let mut network = Network::from_safetensors(&std::fs::read(file)?)?;
    let mut bytes = Vec::new();
    std::io::stdin().read_to_end(&mut bytes)?;
    let (numbers, _) = bytes.as_chunks::<4>();
    let values: Vec<f32> = numbers.iter().map(|&number| f32::from_le_bytes(number)).collect();
    let inputs: Vec<&[f32]> = values.chunks_exact(network.architecture().input().len()).collect();
    for input in &inputs {
        let results: Vec<String> = network.run(input)?.iter().map(f32::to_string).collect();
        println!("{}", results.join(" "));
    }
    let mut times = Vec::new();
    for input in inputs.iter().cycle().take(RUNS.min(RUNS * inputs.len())) {
        let start = Instant::now();
        network.run(input)?;
        times.push(1e3 * start.elapsed().as_secs_f64());
    }
    times.sort_by(f64::total_cmp);
    eprintln!("{:.3}", times.get(times.len() / 2).copied().unwrap_or(f64::NAN));
    Ok(())
}
