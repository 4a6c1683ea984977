//! A checkpoint of an evolution. What is loaded goes on, and comes back from its writer.
#![no_main]

use libfuzzer_sys::fuzz_target;
use roverlab::evolve::{Genetic, Population, Recipe, checkpoint};

fuzz_target!(|bytes: &[u8]| {
    let file = std::env::temp_dir().join(format!("fuzz-checkpoint-{}.json", std::process::id()));
    std::fs::write(&file, bytes).expect("a file");
    if let Ok(Some(population)) = checkpoint::load::<Population<Vec<u8>>>(&file, "fuzz") {
        checkpoint::save(&file, "fuzz", &population).expect("what was loaded is written");
        let again = checkpoint::load::<Population<Vec<u8>>>(&file, "fuzz").expect("and read again");
        assert_eq!(again.map(|again| again.genomes), Some(population.genomes.clone()));
        let _ = Genetic::resume(population, Recipe::book(6));
    }
});
