use proptest::prelude::*;

use super::area::resample_into;
use super::detector::{Window, products};
use super::linear::dot;
use super::{Area, LinearClassifier, LinearTraining, SignFinder, SignPatch, SignTrainer};
use crate::random::Stream;
use crate::vision::network::Network;
use crate::vision::{GrayView, RgbView};

/// Width and height of the pictures of the tests.
const SIZE: (usize, usize) = (96, 72);

/// A picture of gray noise with a sign: a red square with a white bar, or a blue disc.
fn picture(class: usize, sign: Area, stream: &mut Stream) -> Vec<u8> {
    let mut pixels = Vec::new();
    for y in 0..SIZE.1 {
        for x in 0..SIZE.0 {
            let [u, v] = [(x as f64 - sign.left) / sign.width, (y as f64 - sign.top) / sign.height];
            let inside = (0.0..1.0).contains(&u) && (0.0..1.0).contains(&v);
            let noise = 80 + stream.below(60) as u8;
            pixels.extend(match class {
                0 if inside && (0.4..0.6).contains(&v) => [240; 3],
                0 if inside => [200, 30, 40],
                1 if (u - 0.5) * (u - 0.5) + (v - 0.5) * (v - 0.5) < 0.25 => [30, 50, 190],
                _ => [noise; 3],
            });
        }
    }
    pixels
}

fn view(pixels: &[u8]) -> RgbView<'_> {
    RgbView::new(pixels, SIZE.0, SIZE.1).unwrap()
}

fn place(stream: &mut Stream) -> Area {
    let side = stream.between(22.0, 44.0);
    let [left, top] = [SIZE.0, SIZE.1].map(|pixels| stream.between(0.0, pixels as f64 - side));
    Area::new(left, top, side, side)
}

fn trainer() -> SignTrainer {
    let mut stream = Stream::new(5);
    let mut trainer = SignTrainer::new(["bar", "disc"]).unwrap();
    for class in [0, 1].repeat(12) {
        let area = place(&mut stream);
        trainer.add(view(&picture(class, area, &mut stream)), &[(class, area)]).unwrap();
    }
    trainer
}

#[test]
fn signs_are_found_told_apart_and_not_invented() {
    let mut finder = SignFinder::new(trainer().finder(1).unwrap());
    let mut stream = Stream::new(6);
    for class in [0, 1].repeat(10) {
        let area = place(&mut stream);
        let found = finder.find(view(&picture(class, area, &mut stream))).unwrap();
        assert_eq!(found.len(), 1, "{area:?}: {found:?}");
        assert!(found[0].class == class && found[0].area.overlap(&area) > 0.5, "{area:?}: {found:?}");
    }
    let none = Area::new(-500.0, 0.0, 20.0, 20.0);
    let found = finder.find(view(&picture(0, none, &mut stream))).unwrap();
    assert!(found.is_empty(), "{found:?}");
}

#[test]
fn equal_seeds_learn_equal_weights() {
    let trainer = trainer();
    assert_eq!(trainer.finder(3).unwrap(), trainer.finder(3).unwrap());
    assert_ne!(trainer.classifier(3).unwrap(), trainer.classifier(4).unwrap());
}

#[test]
fn nonsense_is_refused() {
    assert!(SignTrainer::new(Vec::<String>::new()).is_err());
    let mut trainer = trainer();
    let pixels = picture(0, Area::new(9.0, 9.0, 30.0, 30.0), &mut Stream::new(1));
    assert!(trainer.add(view(&pixels), &[(2, Area::new(0.0, 0.0, 9.0, 9.0))]).is_err(), "two classes");
    for bad in [f64::NAN, f64::INFINITY, 0.0, -1.0, 1e300] {
        assert!(trainer.add(view(&pixels), &[(0, Area::new(0.0, 0.0, bad, 9.0))]).is_err(), "{bad}");
    }
    let mut finder = SignFinder::new(trainer.classifier(1).unwrap());
    assert!(finder.find(view(&pixels)).is_err(), "it knows no windows");
    assert!(SignTrainer::new(["none"]).unwrap().finder(1).is_err(), "there is no sign");
    let training = LinearTraining::default();
    assert!(LinearClassifier::train(&[1.0, f32::NAN], &[0, 1], 2, training).is_err());
    assert!(LinearClassifier::train(&[1.0, 2.0, 3.0], &[0, 1], 2, training).is_err());
}

#[cfg(feature = "weights")]
#[test]
fn models_are_read_back_and_damage_is_refused() {
    use super::SignModel;
    let trainer = trainer();
    let told = trainer.classifier(1).unwrap().with_network(by_blue()).unwrap();
    for model in [trainer.finder(1).unwrap(), trainer.classifier(1).unwrap(), told] {
        let bytes = model.to_safetensors().unwrap();
        assert_eq!(SignModel::from_safetensors(&bytes).unwrap(), model);
        for length in (0..bytes.len()).step_by(97) {
            assert!(SignModel::from_safetensors(&bytes[..length]).is_err(), "{length}");
        }
    }
}

/// A network whose second class is the bluer one.
fn by_blue() -> Network {
    let pixels = 32 * 32;
    let weights = [[1.0_f32, 0.0, 0.0].repeat(pixels), [0.0, 0.0, 1.0].repeat(pixels)].concat();
    Network::new("32x32x3 dense2".parse().unwrap(), vec![(weights, vec![0.0; 2])]).unwrap()
}

#[test]
fn a_network_has_the_last_word_on_the_class() {
    let named = |names: [&str; 2]| {
        let mut trainer = SignTrainer::new(names).unwrap();
        let mut stream = Stream::new(5);
        for class in [0, 1].repeat(12) {
            let area = place(&mut stream);
            // What is marked is the other way round.
            trainer.add(view(&picture(class, area, &mut stream)), &[(1 - class, area)]).unwrap();
        }
        trainer.finder(1).unwrap()
    };
    let model = named(["disc", "bar"]);
    assert!(
        model
            .clone()
            .with_network(
                Network::new("32x32x3 dense3".parse().unwrap(), vec![(vec![0.0; 9216], vec![0.0; 3])])
                    .unwrap()
            )
            .is_err()
    );
    assert!(
        model
            .clone()
            .with_network(
                Network::new("32x32x1 dense2".parse().unwrap(), vec![(vec![0.0; 2048], vec![0.0; 2])])
                    .unwrap()
            )
            .is_err()
    );
    let (mut before, mut after) =
        (SignFinder::new(model.clone()), SignFinder::new(model.with_network(by_blue()).unwrap()));
    let mut stream = Stream::new(6);
    for class in [0, 1].repeat(4) {
        let area = place(&mut stream);
        let pixels = picture(class, area, &mut stream);
        let [found, told] = [&mut before, &mut after].map(|finder| finder.find(view(&pixels)).unwrap());
        assert_eq!((found[0].class, told[0].class), (1 - class, class));
        assert_eq!((found[0].area, found[0].score), (told[0].area, told[0].score));
        assert_eq!(after.classify(view(&pixels), area).unwrap().0, class);
    }
}

/// A sign in the shade before a bright sky looks as in the light.
#[test]
fn light_is_that_of_the_middle() {
    let sign = |x: usize, y: usize| (x / 8 + y / 8).is_multiple_of(2);
    let shown = |bright: u8, dark: u8, sky: u8| {
        let pixels: Vec<u8> = (0..64 * 64)
            .flat_map(|i| {
                let (x, y) = (i % 64, i / 64);
                let inside = (8..56).contains(&x) && (8..56).contains(&y);
                [if !inside {
                    sky
                } else if sign(x, y) {
                    bright
                } else {
                    dark
                }; 3]
            })
            .collect();
        let all = Area::new(0.0, 0.0, 64.0, 64.0);
        SignPatch::default().read(RgbView::new(&pixels, 64, 64).unwrap(), all).unwrap().to_vec()
    };
    let (light, shade) = (shown(200, 100, 150), shown(50, 25, 255));
    let middle = |values: &[f32]| -> Vec<f32> {
        (10..22).flat_map(|y| values[3 * (32 * y + 10)..3 * (32 * y + 22)].to_vec()).collect()
    };
    for (a, b) in middle(&light).into_iter().zip(middle(&shade)) {
        assert!((a - b).abs() < 0.25, "{a} {b}");
    }
}

#[test]
fn patches_vary_and_rare_classes_are_shown_oftener() {
    let mut trainer = SignTrainer::new(["bar", "disc"]).unwrap();
    let mut stream = Stream::new(5);
    for class in [0; 9].into_iter().chain([1]) {
        let area = place(&mut stream);
        trainer.add(view(&picture(class, area, &mut stream)), &[(class, area)]).unwrap();
    }
    let patches = trainer.patches().unwrap();
    let mut shown = vec![0.0; 3 * SignPatch::SIDE * SignPatch::SIDE];
    let (mut discs, mut before) = (0, Vec::new());
    for seed in 0..400 {
        discs += patches.vary(&mut Stream::new(seed), &mut shown);
        assert!(shown.iter().all(|value| value.abs() <= 2.5) && shown != before);
        before.clone_from(&shown);
    }
    // In proportion to the root of the number: one to three.
    assert!((80..120).contains(&discs), "{discs}");
    assert_eq!(
        patches.vary(&mut Stream::new(399), &mut shown),
        patches.vary(&mut Stream::new(399), &mut before)
    );
    assert_eq!(shown, before);
}

proptest! {
    #![proptest_config(crate::testing::cases(32))]
    /// The weights of a support vector machine separate what can be separated.
    #[test]
    fn samples_beside_a_line_are_learned(a in -2.0..2.0f32, b in -2.0..2.0f32, c in -1.0..1.0f32, seed in 0..99u64) {
        let mut stream = Stream::new(seed);
        let mut draw = || stream.between(-2.0, 2.0) as f32;
        let points: Vec<[f32; 2]> = (0..60).map(|_| [draw(), draw()]).collect();
        let far: Vec<[f32; 2]> = points.into_iter().filter(|[x, y]| (a * x + b * y + c).abs() > 0.5).collect();
        prop_assume!(far.len() > 10);
        let labels: Vec<usize> = far.iter().map(|[x, y]| usize::from(a * x + b * y + c < 0.0)).collect();
        let training = LinearTraining { cost: 1000.0, passes: 400, seed };
        let classifier = LinearClassifier::train(far.as_flattened(), &labels, 1, training).unwrap();
        for (point, &label) in far.iter().zip(&labels) {
            let mut score = [0.0];
            classifier.scores(point, &mut score).unwrap();
            prop_assert_eq!(score[0] > 0.0, label == 0, "{:?}: {}", point, score[0]);
        }
    }

    #[test]
    fn scalar_products_are_those_of_the_definition(values in proptest::collection::vec(-9.0..9.0f32, 0..99)) {
        let sum: f64 = values.iter().map(|&value| f64::from(value) * f64::from(value)).sum();
        prop_assert!((f64::from(dot(&values, &values)) - sum).abs() <= 1e-5 * sum);
    }

    /// Also where several are computed at a time.
    #[test]
    fn products_of_windows_are_those_of_the_definition(count in 1..10usize, seed in 0..99u64) {
        let mut stream = Stream::new(seed);
        let mut draw = || -> [[[f32; 36]; 5]; 5] {
            std::array::from_fn(|_| [[0; 36]; 5].map(|row| row.map(|_| stream.uniform() as f32)))
        };
        let (weights, windows) = (draw(), (0..count).map(|_| draw()).collect::<Vec<_>>());
        let many: Vec<Window<'_>> = windows.iter().map(<[_; 5]>::each_ref).collect();
        let mut found = vec![0.0; count];
        products(&many, &weights.each_ref(), &mut found);
        for (window, &found) in many.iter().zip(&found) {
            let mut alone = [0.0];
            products(&[*window], &weights.each_ref(), &mut alone);
            prop_assert_eq!(alone[0], found);
            let rows = window.iter().zip(&weights);
            let pairs = rows.flat_map(|(a, b)| a.as_flattened().iter().zip(b.as_flattened()));
            let sum: f64 = pairs.map(|(&a, &b)| f64::from(a) * f64::from(b)).sum();
            prop_assert!((f64::from(found) - sum).abs() < 1e-5 * sum, "{} for {}", found, sum);
        }
    }

    /// Scaled to its own size, an image stays as it is; scaled to one pixel, it is its mean.
    #[test]
    fn patches_show_the_image(width in 1..20usize, height in 1..20usize, seed in 0..99u64) {
        let mut stream = Stream::new(seed);
        let pixels: Vec<u8> = (0..width * height).map(|_| stream.below(256) as u8).collect();
        let (image, mut patch) = (GrayView::new(&pixels, width, height).unwrap(), Vec::new());
        let all = Area::new(0.0, 0.0, width as f64, height as f64);
        resample_into(image, all, (width, height), &mut patch);
        prop_assert_eq!(&patch, &pixels);
        if width <= 8 && height <= 8 {
            resample_into(image, all, (1, 1), &mut patch);
            let mean = pixels.iter().map(|&pixel| f64::from(pixel)).sum::<f64>() / pixels.len() as f64;
            prop_assert!((f64::from(patch[0]) - mean).abs() <= 0.51, "{} for {}", patch[0], mean);
        }
    }
}
