use super::{Architecture, FixedNetwork, Layer, MapSize, Network, softmax};
use crate::random::Stream;

/// A network of random weights.
pub(crate) fn random_network(architecture: &str, seed: u64) -> Network {
    let architecture: Architecture = architecture.parse().unwrap();
    let mut random = Stream::new(seed);
    let mut layer = |(filters, taps): (usize, usize)| {
        let spread = (2.0 / taps as f64).sqrt();
        let weights = (0..filters * taps).map(|_| (spread * random.normal()) as f32).collect();
        (weights, (0..filters).map(|_| (0.1 * random.normal()) as f32).collect())
    };
    let weights = architecture.filters().flatten().map(&mut layer).collect();
    Network::new(architecture, weights).unwrap()
}

fn random_input(network: &Network, seed: u64) -> Vec<f32> {
    let mut random = Stream::new(seed).child("input", 0);
    (0..network.architecture().input().len()).map(|_| random.normal() as f32).collect()
}

/// The definition: every sum from the constant on, in the order of rows, columns and channels.
fn by_definition(network: &Network, input: &[f32]) -> Vec<f32> {
    let architecture = network.architecture();
    let (mut map, mut weights) = (input.to_vec(), network.weights().into_iter());
    let last = architecture.layers().len() - 1;
    for (index, &layer) in architecture.layers().iter().enumerate() {
        let (from, to) = (architecture.sizes()[index], architecture.sizes()[index + 1]);
        let mut result = Vec::new();
        let at = |map: &[f32], y: usize, x: usize, channel: usize| {
            map[(y * from.width + x) * from.channels + channel]
        };
        if let Layer::Pool { size } = layer {
            for (y, x, channel) in places(to) {
                let inside =
                    (0..size * size).map(|i| at(&map, y * size + i / size, x * size + i % size, channel));
                result.push(inside.fold(f32::NEG_INFINITY, f32::max));
            }
        } else {
            let (weights, constants) = weights.next().unwrap();
            let taps = weights.len() / constants.len();
            for (y, x, filter) in places(to) {
                let mut sum = constants[filter];
                for (tap, weight) in weights[filter * taps..][..taps].iter().enumerate() {
                    let value = match layer {
                        Layer::Convolution { size, stride, .. } => {
                            let (row, rest) = (tap / (size * from.channels), tap % (size * from.channels));
                            let (column, channel) = (rest / from.channels, rest % from.channels);
                            at(&map, y * stride + row, x * stride + column, channel)
                        }
                        _ => map[tap],
                    };
                    sum += weight * value;
                }
                result.push(if index < last && sum < 0.0 { 0.0 } else { sum });
            }
        }
        map = result;
    }
    map
}

fn places(size: MapSize) -> impl Iterator<Item = (usize, usize, usize)> {
    let MapSize { height, width, channels } = size;
    (0..height)
        .flat_map(move |y| (0..width).flat_map(move |x| (0..channels).map(move |channel| (y, x, channel))))
}

const NETWORKS: [&str; 5] = [
    "12x17x3 conv5/3/2 conv20/3/1 dense7 dense1",
    "9x11x1 conv16/5/1 pool2 dense33 dense10",
    "1x4x1 dense17 dense17 dense2",
    "7x7x2 conv3/7/1",
    "20x30x1 conv8/3/1 pool2 conv16/3/2 pool2 dense5",
];

#[test]
fn results_are_those_of_the_definition_to_the_bit() {
    for (seed, architecture) in (1..).zip(NETWORKS) {
        let mut network = random_network(architecture, seed);
        for case in 0..5 {
            let input = random_input(&network, case);
            let expected = by_definition(&network, &input);
            let found = network.run(&input).unwrap();
            assert!(found.iter().zip(&expected).all(|(a, b)| a.to_bits() == b.to_bits()), "{architecture}");
        }
        let again = Network::new(network.architecture().clone(), network.weights()).unwrap();
        assert_eq!(again, network);
    }
}

#[test]
fn whole_numbers_are_as_good_as_sixteen_bits_allow() {
    for (seed, architecture) in (1..).zip(NETWORKS) {
        let mut network = random_network(architecture, seed);
        let inputs: Vec<Vec<f32>> = (0..50).map(|case| random_input(&network, case)).collect();
        let mut fixed = FixedNetwork::new(&mut network, inputs.iter().map(Vec::as_slice)).unwrap();
        for input in &inputs {
            let exact = network.run(input).unwrap();
            let most = exact.iter().fold(1.0_f32, |most, value| most.max(value.abs()));
            for (exact, fixed) in exact.iter().zip(fixed.run(input).unwrap()) {
                assert!((exact - fixed).abs() < 0.01 * most, "{architecture}: {exact} {fixed}");
            }
        }
    }
}

/// Values beyond those that it was made for are cut off; sums do not overflow, which tests would notice.
#[test]
fn whole_numbers_bear_any_input() {
    let mut network = random_network(NETWORKS[0], 1);
    let small = vec![0.001; network.architecture().input().len()];
    let mut fixed = FixedNetwork::new(&mut network, [small.as_slice()]).unwrap();
    for value in [f32::MAX, f32::MIN, f32::INFINITY, f32::NAN, 1e9] {
        assert!(fixed.run(&vec![value; small.len()]).unwrap().iter().all(|result| result.is_finite()));
    }
    assert!(FixedNetwork::new(&mut network, []).is_err());
    assert!(FixedNetwork::new(&mut network, [vec![f32::NAN; small.len()].as_slice()]).is_err());
    let chain: Architecture = "1x1x1 dense1 dense1 dense1".parse().unwrap();
    for weight in [1e12, 1e30] {
        let mut huge = Network::new(chain.clone(), vec![(vec![weight], vec![0.0]); 3]).unwrap();
        assert!(FixedNetwork::new(&mut huge, [[1.0].as_slice()]).is_err());
    }
    assert!(fixed.run(&[0.0]).is_err() && network.run(&[0.0]).is_err());
}

#[test]
fn what_is_no_architecture_is_refused() {
    let bad = [
        "",
        "3x3",
        "3x3x0 dense1",
        "3x3x1",
        "3x3x1 pool2",
        "3x3x1 pool0 dense1",
        "3x3x1 conv2/4/1",
        "3x3x1 conv2/1",
        "3x3x1 conv2/1/0",
        "3x3x1 dense",
        "3x3x1 relu dense1",
        "4096x4096x4096 dense1",
        "4000x4000x1 conv4000/1/1 dense1",
        "100x100x1 dense4096 dense4096",
        "3x3x1 dense99999999999999999999",
        "4096x4096x4096 conv1/1/4096 dense1",
        "4096x4096x1 conv4096/4096/1 dense1",
        "3000x3000x1 conv1/1/1 conv1/1/1 dense1",
        "3x3x1 dense4 conv2/1/1 dense1",
        "3x3x1 dense4 pool1 dense1",
    ];
    for text in bad {
        assert!(text.parse::<Architecture>().is_err(), "{text}");
    }
    // Nine million weights, of which each takes the room of 16.
    let wide = "3000x3000x1 dense1".parse::<Architecture>().unwrap_err();
    assert_eq!(wide.name(), "number of weights");
    assert!("512x512x1 dense16".parse::<Architecture>().is_ok());
    let one: Architecture = "1x2x1 dense1".parse().unwrap();
    for weights in [vec![], vec![(vec![1.0], vec![0.0])], vec![(vec![1.0, f32::NAN], vec![0.0])]] {
        assert!(Network::new(one.clone(), weights).is_err());
    }
}

#[test]
fn attention_is_where_the_picture_is_not_empty() {
    let network = "10x10x1 conv2/3/1 conv2/3/1 dense1".parse().unwrap();
    let ones = |count: usize| vec![1.0; count];
    let weights = vec![(ones(18), vec![0.0; 2]), (ones(36), vec![0.0; 2]), (ones(72), vec![0.0])];
    let mut network = Network::new(network, weights).unwrap();
    let mut picture = vec![0.0; 100];
    picture[22] = 1.0;
    network.run(&picture).unwrap();
    let attention = network.attention();
    assert_eq!((attention.len(), attention[22]), (100, 1.0));
    assert_eq!(attention[99], 0.0, "nothing in the far corner");
}

#[test]
fn probabilities_sum_to_one() {
    let shares = softmax(&[3.0, -2.0, 0.5]);
    assert!(
        (shares.iter().sum::<f64>() - 1.0).abs() < 1e-12 && shares[0] > shares[2] && shares[2] > shares[1]
    );
    assert!(softmax(&[]).is_empty());
}

#[cfg(feature = "weights")]
#[test]
fn files_keep_networks_to_sixteen_bits_and_damage_is_told() {
    for (seed, architecture) in (1..).zip(NETWORKS) {
        let network = random_network(architecture, seed);
        let bytes = network.to_safetensors().unwrap();
        let mut read = Network::from_safetensors(&bytes).unwrap();
        let input = random_input(&network, 3);
        let exact = by_definition(&network, &input);
        for (exact, rounded) in exact.iter().zip(read.run(&input).unwrap()) {
            assert!((exact - rounded).abs() < 1e-2, "{architecture}: {exact} {rounded}");
        }
        for cut in (0..bytes.len()).step_by(97) {
            assert!(Network::from_safetensors(&bytes[..cut]).is_err());
        }
    }
    let bytes = random_network(NETWORKS[2], 1).to_safetensors().unwrap();
    let text = String::from_utf8_lossy(&bytes).replace("dense17 dense17", "dense17 dense18");
    assert!(Network::from_safetensors(text.as_bytes()).is_err());
}
