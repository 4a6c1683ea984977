//! Starman (book, chapter 12): a round robot with five limbs learns to walk. Bytes code the positions of its
//! servos, and the book's genetic algorithm breeds those that bring it far along the floor. Needs the feature
//! `physics`.
//!
//! `cargo run --release --features physics --example starman`

use roverlab::evolve::{Evolution, Gait, Genetic, Recipe, Serial, StopRules, Trial};
use roverlab::geometry::{Point, units};
use roverlab::io::control::run;
use roverlab::io::sim::starman::{LIMBS, Starman, StarmanPosture, StarmanSpec};
use roverlab::io::{Odometry, Result};
use roverlab::picture::{Picture, Style, ramp};
use roverlab::random::Stream;
use roverlab::world::World;

fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    // Ten control points for five servos each; at first, each byte is within 40 of the one before.
    let mut random = Stream::new(1);
    let genomes = (0..10).map(|_| Gait::near_middle(LIMBS, 10, 40, &mut random)).collect::<Result<_>>()?;
    let mut evolution = Genetic::new(genomes, Recipe::book(24), 1)?;
    // The book's wheel of fitness needs positive numbers.
    let fitness = |bytes: &Vec<u8>, _: Trial| Ok(1.0 + units::to_mm(walk(bytes, |_| {})?.abs()));
    evolution.run(&mut Serial::new(fitness), &StopRules::generations(10), |_| Ok(()))?;

    let history = evolution.history();
    for row in history {
        println!(
            "generation {:2}: best {:5.0} mm, mean {:5.0} mm",
            row.generation,
            row.best - 1.0,
            row.mean - 1.0
        );
    }
    let best = &evolution.best().ok_or("nobody is there")?.genome;
    let mut strip = Vec::new();
    let way = walk(best, |posture| strip.push(posture))?;
    println!("The best gait brings it {:.0} mm along the floor in 5 s.", units::to_mm(way.abs()));
    // The same bytes walk the same way.
    assert_eq!(1.0 + units::to_mm(way.abs()), history[9].best);
    assert!(history[9].best > 2.0 * history[0].best);

    let mut picture = Picture::new(&World::empty(0.6, 0.4));
    picture.title("A gait, from blue to red");
    let last = strip.len() as f64 - 1.0;
    let at = |(x, y): (f64, f64)| Point::new(0.3 + x, 0.05 + y);
    for (index, posture) in strip.iter().enumerate().step_by(3) {
        let style = Style::new(ramp(index as f64 / last)).opacity(0.6);
        picture.disc(at(posture.body), StarmanSpec::book().body_radius, style.clone());
        for limb in &posture.segments {
            picture.line(limb.map(at), style.clone());
        }
    }
    picture.save("target/pictures/starman.svg")?;
    Ok(())
}

/// Metres along the floor that a gait brings a Starman in 20 control points; `watch` is shown its postures.
fn walk(bytes: &[u8], mut watch: impl FnMut(StarmanPosture)) -> Result<f64> {
    let mut starman = Starman::new(&StarmanSpec::book())?;
    let gait = Gait::from_bytes(bytes, LIMBS, 0)?;
    gait.settle(&mut starman)?;
    let start = starman.pose()?.x;
    // Each control point is held for a moment; after the last one the first one follows again.
    let seconds = 20.0 * Gait::PERIOD;
    run(&mut starman, &mut gait.walking(), seconds, |starman, _, _| watch(starman.truth().posture))?;
    Ok(starman.pose()?.x - start)
}
