//! A genetic algorithm (book, section 12.3): the gains of a PID controller that follows a wall, bred over
//! some generations. A controller is the fitter the nearer it keeps the robot to its distance from the wall.
//!
//! `cargo run --release --example genetic`

use std::ops::Range;

use roverlab::drive::{AlongWall, PidParameters, PidWallFollower, PidWallFollowerParameters};
use roverlab::evolve::{
    Arithmetic, Evolution, Gaussian, Genetic, Recipe, Selection, Serial, StopRules, Trial, chart,
};
use roverlab::geometry::{Pose, units};
use roverlab::io::Result;
use roverlab::io::control::run;
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::random::Stream;
use roverlab::world::{RobotSpec, Scene, World};

fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    // Genes between 0 and 1 stand for gains. At first all are small: these controllers hardly steer.
    let mut random = Stream::new(1);
    let genomes = (0..16).map(|_| (0..3).map(|_| random.between(0.0, 0.1)).collect()).collect();
    let recipe = Recipe {
        selection: Selection::Tournament { size: 3 },
        crossover: Box::new(Arithmetic),
        mutation: Box::new(Gaussian { probability: 0.4, sigma: 0.1, low: 0.0, high: 1.0 }),
        elite: 1,
    };
    let mut evolution = Genetic::new(genomes, recipe, 1)?;
    // The mean of three runs with other noise, so that no controller owes its fitness to a lucky one.
    let fitness = |genes: &Vec<f64>, _: Trial| Ok(-mean_error(genes, 0..3)?);
    evolution.run(&mut Serial::new(fitness), &StopRules::generations(12), |_| Ok(()))?;

    println!("{:>10} {:>12} {:>12}", "generation", "best (mm)", "mean (mm)");
    for row in evolution.history() {
        println!(
            "{:>10} {:>12.1} {:>12.1}",
            row.generation,
            -units::to_mm(row.best),
            -units::to_mm(row.mean)
        );
    }
    let best = &evolution.best().ok_or("nobody is there")?.genome;
    let [proportional, integral, derivative] = gains(best);
    println!("\nproportional {proportional:.2}, integral {integral:.2}, derivative {derivative:.2}");
    // In runs that no trial has seen.
    let unseen = mean_error(best, 1000..1010)?;
    println!("{:.1} mm from the line in ten new runs", units::to_mm(unseen));
    let (first, last) = (evolution.history()[0], evolution.history()[11]);
    assert!(last.best > 0.5 * first.best && last.mean > first.mean && unseen < 0.01);

    chart(evolution.history()).save("target/pictures/genetic.svg")?;
    Ok(())
}

/// Proportional 0 to 20, integral 0 to 4, derivative 0 to 30.
fn gains(genes: &[f64]) -> [f64; 3] {
    [20.0 * genes[0], 4.0 * genes[1], 30.0 * genes[2]]
}

fn mean_error(genes: &[f64], seeds: Range<u64>) -> Result<f64> {
    let runs = (seeds.end - seeds.start) as f64;
    Ok(seeds.map(|seed| error(genes, seed)).sum::<Result<f64>>()? / runs)
}

/// Metres off the line in the mean (root of the mean square), on a run of 15 s; a contact adds 100 mm.
fn error(genes: &[f64], seed: u64) -> Result<f64> {
    let scene = Scene::with_robot(World::walled(6.0, 2.0), RobotSpec::s4(), Pose::new(0.5, 1.65, 0.2));
    let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, seed))?;
    let [proportional, integral, derivative] = gains(genes);
    let base = PidWallFollowerParameters::default();
    let gains = PidParameters { proportional, integral, derivative, ..base.gains };
    let controller = PidWallFollower::new(PidWallFollowerParameters { gains, ..base })?;
    let truth = simulation.truth();
    let (mut squares, mut count) = (0.0, 0.0);
    run(&mut simulation.robot(0)?, &mut AlongWall::new(controller), 15.0, |_, _, step| {
        if step.time > 4.0 {
            let off = 2.0 - truth.pose(0).map_or(0.0, |pose| pose.y) - base.distance;
            squares += off * off;
            count += 1.0;
        }
    })?;
    Ok((squares / f64::max(count, 1.0)).sqrt() + 0.1 * f64::from(truth.robot(0)?.contacts))
}
