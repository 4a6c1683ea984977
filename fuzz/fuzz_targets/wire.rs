//! What programs for RoBIOS and the process with their world tell each other: questions, and answers.
#![no_main]

use eyesim::wire::{Answer, Question};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Some(question) = Question::decode(bytes) {
        assert_eq!(question.encode(), bytes);
    }
    if let Some(answer) = Answer::decode(bytes) {
        let told = answer.encode();
        let again = Answer::decode(&told).expect("what is encoded is an answer");
        assert_eq!(again.encode(), told);
    }
});
