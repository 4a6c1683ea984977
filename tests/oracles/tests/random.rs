//! Streams are generators for the distributions of other crates.

use rand_distr::{Distribution, Normal, Poisson};
use roverlab::random::Stream;

#[test]
fn distributions_draw_from_a_stream() {
    let mut stream = Stream::new(5);
    let numbers = 50_000;
    let normal = Normal::new(3.0, 2.0).unwrap();
    let mean = (0..numbers).map(|_| normal.sample(&mut stream)).sum::<f64>() / f64::from(numbers);
    assert!((mean - 3.0).abs() < 0.05, "{mean}");
    let poisson = Poisson::new(4.0).unwrap();
    let mean = (0..numbers).map(|_| poisson.sample(&mut stream)).sum::<f64>() / f64::from(numbers);
    assert!((mean - 4.0).abs() < 0.05, "{mean}");
}

#[test]
fn what_a_distribution_draws_is_what_the_stream_gives() {
    let mut stream = Stream::new(6);
    let drawn: u64 = rand_distr::Uniform::new_inclusive(0, u64::MAX).unwrap().sample(&mut stream.clone());
    assert_eq!(drawn, stream.bits());
}
