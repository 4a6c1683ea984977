use serde_json::Value;

use super::{Part, Portable, portable};

#[derive(Debug, Clone, PartialEq)]
struct Sample {
    error: Option<f64>,
    places: Vec<(f64, usize, u32)>,
    both: [f64; 2],
    ending: String,
    kind: Kind,
    good: bool,
    seed: u64,
}

portable!(struct Sample { error, places, both, ending, kind, good, seed });

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Wall,
    Circle,
}

portable!(
    enum Kind {
        Wall,
        Circle,
    }
);

/// A result as it comes out of a file.
fn through_text<T: Portable>(value: &T) -> Result<T, String> {
    let text = serde_json::to_string(&value.packed()).unwrap();
    T::unpacked(&serde_json::from_str::<Value>(&text).unwrap())
}

#[test]
fn numbers_keep_their_bits() {
    let odd = [
        0.0,
        -0.0,
        1.0,
        0.1,
        -1.0 / 3.0,
        f64::MAX,
        f64::MIN_POSITIVE,
        5e-324,
        f64::EPSILON,
        1e300,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NAN,
        -f64::NAN,
        f64::from_bits(0x7ff0_0000_0000_0001),
    ];
    for number in odd {
        assert_eq!(through_text(&number).unwrap().to_bits(), number.to_bits(), "{number}");
    }
    for number in [0, 1, u64::from(u32::MAX), u64::MAX] {
        assert_eq!(through_text(&number), Ok(number));
    }
}

proptest::proptest! {
    #![proptest_config(roverlab::testing::cases(512))]

    #[test]
    fn any_bits_survive(bits: u64) {
        let number = f64::from_bits(bits);
        proptest::prop_assert_eq!(through_text(&number).unwrap().to_bits(), bits);
    }

    #[test]
    fn runs_are_in_one_part_each(of in 1_u64..40, runs in 0_u64..200) {
        let parts = (1..=of).map(|number| Part { number, of });
        let mut all: Vec<u64> =
            parts.flat_map(|part| (0..part.runs(runs)).map(move |index| part.run(index))).collect();
        all.sort_unstable();
        proptest::prop_assert_eq!(all, (0..runs).collect::<Vec<_>>());
    }
}

#[test]
fn compounds_come_back() {
    let sample = Sample {
        error: None,
        places: vec![(0.25, 3, 7), (f64::INFINITY, 0, u32::MAX)],
        both: [1.0, -2.5],
        ending: "a \"word\"\nand a line".into(),
        kind: Kind::Circle,
        good: true,
        seed: u64::MAX,
    };
    assert_eq!(through_text(&sample).unwrap(), sample);
    let other = Sample { error: Some(0.5), places: Vec::new(), kind: Kind::Wall, ..sample };
    assert_eq!(through_text(&other).unwrap(), other);
}

#[test]
fn wrong_results_are_refused() {
    let refused = |text: &str| Sample::unpacked(&serde_json::from_str(text).unwrap()).unwrap_err();
    assert_eq!(refused("[]"), "found a list, expected an object");
    assert!(refused("{}").contains("found no field error, expected one"));
    assert!(refused(r#"{"extra": 1}"#).contains("found the field \"extra\", expected error, places"));
    assert_eq!(refused(r#"{"error": "nan:0000000000000000"}"#).find("error: found"), Some(0));
    assert!(<[f64; 2]>::unpacked(&serde_json::json!([1, 2, 3])).unwrap_err().contains("expected one of 2"));
    assert!(u32::unpacked(&serde_json::json!(1_u64 << 32)).is_err());
    assert!(u32::unpacked(&serde_json::json!(-1)).is_err());
    assert!(<(f64, bool)>::unpacked(&serde_json::json!([1])).is_err());
    assert!(Kind::unpacked(&"Square".into()).unwrap_err().contains("expected one of Wall, Circle"));
}

#[test]
fn parts_are_named_by_number_and_count() {
    assert_eq!("2/4".parse(), Ok(Part { number: 2, of: 4 }));
    assert_eq!(Part { number: 2, of: 4 }.to_string(), "2/4");
    for text in ["", "2", "0/4", "5/4", "-1/2", "1/0", "1/100001", "a/b", "1/2/3", "1.5/2"] {
        assert!(text.parse::<Part>().unwrap_err().contains("expected K/N"), "{text}");
    }
}
