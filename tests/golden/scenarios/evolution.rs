//! Evolution, and the robot that learns to walk by it.

use roverlab::evolve::{
    Arithmetic, BitFlip, CmaEs, Evolution, Gaussian, Genetic, Genome, OnePoint, Recipe, Selection, Serial,
    SteadyState, StopRules, Trial, Uniform, table,
};
use roverlab::io::Result;
use roverlab::random::Stream;

use super::{Scenario, note};

pub(super) const SCENARIOS: &[Scenario] = &[
    Scenario::new("genetic", genetic),
    Scenario::new("steady-state", steady_state),
    Scenario::new("cma-es", cma_es),
    #[cfg(feature = "physics")]
    Scenario::new("starman", starman),
    #[cfg(not(feature = "physics"))]
    Scenario::without("starman", "built without the feature `physics`"),
];

/// Runs an evolution and notes every generation with all of its genomes.
fn evolved<G: Genome>(
    log: &mut String,
    evolution: &mut impl Evolution<G>,
    generations: u64,
    fitness: impl FnMut(&G, Trial) -> Result<f64>,
) -> Result<()> {
    let rules = StopRules { stagnation: Some(30), ..StopRules::generations(generations) };
    let reason = evolution.run(&mut Serial::new(fitness), &rules, |now| {
        let population = now.population();
        note(log, "generation", &(population.generation, &population.genomes, &population.fitness));
        Ok(())
    })?;
    *log += &table(evolution.history());
    let best = evolution.best().map(|best| (&best.genome, best.fitness));
    note(log, "best", &(reason, best, evolution.population().hash()));
    Ok(())
}

/// Bytes by the book's recipe and by others, with a fitness that chance has a part in.
fn genetic() -> Result<String> {
    let mut log = String::new();
    let ones = |genome: &Vec<u8>, trial: Trial| {
        let ones: u32 = genome.iter().map(|byte| byte.count_ones()).sum();
        Ok(f64::from(ones) + trial.random().uniform())
    };
    let first = || -> Vec<Vec<u8>> {
        let mut random = Stream::new(131);
        (0..12).map(|_| (0..6).map(|_| random.below(256) as u8).collect()).collect()
    };
    let recipe = |selection, elite| Recipe {
        selection,
        crossover: Box::new(Uniform { probability: 0.3 }),
        mutation: Box::new(BitFlip { count: 2 }),
        elite,
    };
    evolved(&mut log, &mut Genetic::new(first(), Recipe::book(6), 131)?, 15, ones)?;
    let one_point = Recipe { crossover: Box::new(OnePoint), ..recipe(Selection::Wheel, 2) };
    for recipe in [
        one_point,
        recipe(Selection::Tournament { size: 3 }, 1),
        recipe(Selection::Rank { pressure: 1.6 }, 0),
    ] {
        evolved(&mut log, &mut Genetic::new(first(), recipe, 132)?, 10, ones)?;
    }
    Ok(log)
}

/// The valley of Rosenbrock, upside down.
fn valley(genome: &[f64]) -> f64 {
    let terms = genome.windows(2).map(|pair| {
        let (bend, rest) = (pair[1] - pair[0] * pair[0], 1.0 - pair[0]);
        100.0 * bend * bend + rest * rest
    });
    -terms.sum::<f64>()
}

fn steady_state() -> Result<String> {
    let mut random = Stream::new(133);
    let first: Vec<Vec<f64>> = (0..10).map(|_| (0..3).map(|_| random.between(-2.0, 2.0)).collect()).collect();
    let recipe = Recipe {
        selection: Selection::Tournament { size: 2 },
        crossover: Box::new(Arithmetic),
        mutation: Box::new(Gaussian { probability: 0.5, sigma: 0.2, low: -2.0, high: 2.0 }),
        elite: 1,
    };
    let mut log = String::new();
    let mut evolution = SteadyState::new(first, recipe, 4, 133)?;
    evolved(&mut log, &mut evolution, 30, |genome: &Vec<f64>, _| Ok(valley(genome)))?;
    Ok(log)
}

fn cma_es() -> Result<String> {
    let mut log = String::new();
    let individuals = CmaEs::usual_individuals(4);
    let mut evolution = CmaEs::new(vec![-1.0, 0.5, 0.0, 1.5], 0.4, individuals, 134)?;
    evolved(&mut log, &mut evolution, 25, |genome: &Vec<f64>, _| Ok(valley(genome)))?;
    let distribution = evolution.distribution();
    note(&mut log, "distribution", &(&distribution.mean, distribution.sigma, &distribution.covariance));
    Ok(log)
}

/// Gaits that evolve on the walking robot, and the postures on the way of one of them.
#[cfg(feature = "physics")]
fn starman() -> Result<String> {
    use roverlab::evolve::Gait;
    use roverlab::io::sim::starman::{LIMBS, Starman, StarmanSpec};
    use roverlab::io::{Clock, Odometry, Servos};

    let mut log = String::new();
    for spec in [StarmanSpec::book(), StarmanSpec::planar()] {
        let mut robot = Starman::new(&spec)?;
        for step in 0..8 {
            robot.set_servo(1 + step % 5, if step % 2 == 0 { 0.9 } else { 0.1 })?;
            for _ in 0..5 {
                robot.wait(0.1)?;
                let truth = robot.truth();
                let posture = (truth.posture.body, truth.posture.roll, truth.posture.limbs);
                note(&mut log, "posture", &(robot.pose()?, posture, truth.posture.segments, truth.energy));
            }
        }
    }
    let mut random = Stream::new(135);
    let first = (0..6).map(|_| Gait::near_middle(LIMBS, 6, 40, &mut random).unwrap()).collect();
    let fitness = |bytes: &Vec<u8>, _: Trial| {
        let mut robot = Starman::new(&StarmanSpec::planar())?;
        let gait = Gait::from_bytes(bytes, LIMBS, 2)?;
        gait.settle(&mut robot)?;
        gait.walk(&mut robot, 2.0)?;
        Ok(robot.pose()?.x.abs())
    };
    evolved(&mut log, &mut Genetic::new(first, Recipe::book(10), 135)?, 4, fitness)?;
    Ok(log)
}
