use std::num::NonZero;

use super::{Examples, Loss, Trainer, TrainerOptions};
use crate::random::Stream;
use crate::vision::network::Architecture;

/// Pictures of 8 x 8 pixels with a bright column; where it is.
struct Columns {
    classes: bool,
}

impl Examples for Columns {
    fn count(&self) -> usize {
        70
    }

    fn write(&self, index: usize, random: &mut Stream, input: &mut [f32]) -> f32 {
        let column = index % 8;
        for (place, value) in input.iter_mut().enumerate() {
            *value = (0.1 * random.normal()) as f32 + f32::from(u8::from(place % 8 == column));
        }
        if self.classes { column as f32 } else { column as f32 / 8.0 }
    }
}

fn architecture(results: usize) -> Architecture {
    format!("8x8x1 conv6/3/1 pool2 dense12 dense{results}").parse().unwrap()
}

fn options(threads: usize, loss: Loss) -> TrainerOptions {
    TrainerOptions { threads: NonZero::new(threads).unwrap(), batch: 16, loss, ..TrainerOptions::default() }
}

#[test]
fn it_learns_numbers_and_classes() {
    for (results, loss) in [(1, Loss::Squares), (8, Loss::Classes)] {
        let examples = Columns { classes: loss == Loss::Classes };
        let mut trainer = Trainer::new(architecture(results), options(2, loss)).unwrap();
        let losses: Vec<f64> = (0..30).map(|_| trainer.epoch(&examples, 0.01).unwrap()).collect();
        assert!(losses[29] < 0.1 * losses[0], "{loss:?}: {losses:?}");
        let mut network = trainer.network();
        let mut input = vec![0.0; 64];
        for index in 0..8 {
            let wanted = examples.write(index, &mut Stream::new(9), &mut input);
            let found = network.run(&input).unwrap();
            if loss == Loss::Squares {
                assert!((found[0] - wanted).abs() < 0.15, "{found:?} {wanted}");
            } else {
                let likely = (0..8).max_by(|&a, &b| found[a].total_cmp(&found[b])).unwrap();
                assert_eq!(likely as f32, wanted);
            }
        }
    }
}

/// The framework's results are those of our own layers.
#[test]
fn the_loss_is_that_of_the_network() {
    let examples = Columns { classes: false };
    let mut trainer =
        Trainer::new(architecture(1), TrainerOptions { batch: 70, ..options(1, Loss::Squares) }).unwrap();
    let mut network = trainer.network();
    let stream = Stream::new(1).child("epoch", 0);
    let mut input = vec![0.0; 64];
    let squares = (0..70).map(|index| {
        let wanted = examples.write(index, &mut stream.child("example", index as u64), &mut input);
        let off = f64::from(network.run(&input).unwrap()[0] - wanted);
        off * off
    });
    let expected = squares.sum::<f64>() / 70.0;
    let found = trainer.epoch(&examples, 1e-3).unwrap();
    assert!((found - expected).abs() < 1e-5 * expected.max(1.0), "{found} {expected}");
}

#[test]
fn threads_and_interruptions_change_nothing() {
    let examples = Columns { classes: true };
    let options = |threads| TrainerOptions { hidden: 0.2, ..options(threads, Loss::Classes) };
    let weights = |threads: usize, interrupted: bool| {
        let mut trainer = Trainer::new(architecture(8), options(threads)).unwrap();
        for _ in 0..4 {
            trainer.epoch(&examples, 0.01).unwrap();
            if interrupted {
                let bytes = trainer.to_checkpoint().unwrap();
                trainer = Trainer::from_checkpoint(&bytes, architecture(8), options(1)).unwrap();
            }
        }
        trainer.network().weights()
    };
    let expected = weights(1, false);
    assert_eq!(weights(2, false), expected);
    assert_eq!(weights(4, false), expected);
    assert_eq!(weights(2, true), expected);
}

/// Examples that are none.
struct Bad(f32);

impl Examples for Bad {
    fn count(&self) -> usize {
        3
    }

    fn write(&self, _: usize, _: &mut Stream, input: &mut [f32]) -> f32 {
        input.fill(self.0);
        self.0
    }
}

#[test]
fn what_cannot_be_learned_is_told_and_changes_nothing() {
    assert!(Trainer::new(architecture(2), options(1, Loss::Squares)).is_err());
    assert!(Trainer::new(architecture(1), options(1, Loss::Classes)).is_err());
    for bad in [
        TrainerOptions { batch: 0, ..options(1, Loss::Squares) },
        TrainerOptions { hidden: 1.0, ..options(1, Loss::Squares) },
        TrainerOptions { hidden: f64::NAN, ..options(1, Loss::Squares) },
    ] {
        assert!(Trainer::new(architecture(1), bad).is_err());
    }
    for (bad, loss, results) in
        [(f32::NAN, Loss::Squares, 1), (8.0, Loss::Classes, 8), (-1.0, Loss::Classes, 8)]
    {
        let mut trainer = Trainer::new(architecture(results), options(2, loss)).unwrap();
        let before = trainer.network();
        assert!(trainer.epoch(&Bad(bad), 0.01).is_err());
        assert_eq!(trainer.network(), before);
    }
    let mut trainer = Trainer::new(architecture(1), options(1, Loss::Squares)).unwrap();
    assert!(trainer.epoch(&Bad(1e30), 0.01).is_err(), "the loss is not finite");
    for rate in [0.0, f64::NAN] {
        assert!(trainer.epoch(&Bad(1.0), rate).is_err());
    }
}

#[test]
fn a_damaged_state_is_refused() {
    let trainer = Trainer::new(architecture(1), options(1, Loss::Squares)).unwrap();
    let bytes = trainer.to_checkpoint().unwrap();
    let read = |bytes: &[u8], options| Trainer::from_checkpoint(bytes, architecture(1), options);
    assert!(read(&bytes, options(3, Loss::Squares)).is_ok());
    for cut in (0..bytes.len()).step_by(101) {
        assert!(read(&bytes[..cut], options(1, Loss::Squares)).is_err());
    }
    let other = TrainerOptions { seed: 2, ..options(1, Loss::Squares) };
    assert!(read(&bytes, other).unwrap_err().to_string().contains("expected"));
}

/// Pictures of odd sizes, whose last rows or columns no filter reaches.
struct Odd;

impl Examples for Odd {
    fn count(&self) -> usize {
        2
    }

    fn write(&self, index: usize, random: &mut Stream, input: &mut [f32]) -> f32 {
        input.fill_with(|| random.normal() as f32);
        index as f32
    }
}

#[test]
fn any_architecture_is_trained() {
    let pilot =
        "66x200x3 conv24/5/2 conv36/5/2 conv48/5/2 conv64/3/1 conv64/3/1 dense100 dense50 dense10 dense1";
    for architecture in [
        pilot,
        "8x21x1 conv4/3/1 conv4/5/2 dense1",
        "7x20x1 conv2/3/2 pool2 dense1",
        "5x6x2 conv1/5/1 dense1",
    ] {
        let options = TrainerOptions { batch: 2, ..options(1, Loss::Squares) };
        let mut trainer = Trainer::new(architecture.parse().unwrap(), options).unwrap();
        assert!(trainer.epoch(&Odd, 1e-3).is_ok(), "{architecture}");
    }
}
