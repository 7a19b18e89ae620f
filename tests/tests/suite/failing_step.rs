//! What the diagnosis says of a step that failed: what is new in it, causes that belong to it before what is unusual in the scene, and remedies that the scene can follow.

use crate::failing::{Left, comes_out_well, diagnosed, is_cause, is_mended, run, text_of};
use stoss::diagnosis::{Cause, Confidence, Diagnosis};
use stoss::run::RunError;

/// Whether a diagnosis names a cause, with any certainty.
fn names(diagnosis: &Diagnosis, cause: Cause) -> bool {
    diagnosis.findings.iter().any(|finding| finding.cause == cause)
}

/// Exact stick is found where an interference is closed at once, as a spring is.
#[test]
fn exact_stick_where_an_interference_closes() {
    let text = text_of("exact-stick");
    let springs = text.replace("mu = 0.15", "mu = 0.15, stick = \"penalty\"");
    for text in [&text, &springs] {
        assert_eq!(run(text).result.unwrap_or_else(|e| panic!("{e}")).outcome, stoss::output::Outcome::Completed);
    }
}

/// Slave nodes come and go at the rim of the master: mortar contact, or the rim on the slave, mends it.
#[test]
fn a_rim_of_the_master() {
    let (finding, diagnosis) = diagnosed("open-rim");
    assert_eq!((finding.cause, finding.confidence), (Cause::OpenRim, Confidence::Medium), "{diagnosis:#?}");
    is_mended("open-rim", &finding, 0);
    is_mended("open-rim", &finding, 1);
}

/// Nodes in common of two slaves have two pressures, of which only the sum is determined.
#[test]
fn slaves_with_nodes_in_common() {
    comes_out_well(&text_of("shared-nodes"));
}

/// Fixed rigid bodies that cross are no fault: the load is, and of a run that ends well nothing is said of them.
#[test]
fn fixed_planes_that_cross() {
    let (finding, diagnosis) = diagnosed("crossing-planes");
    is_cause(&finding, Cause::LoadTooLarge);
    assert!(!names(&diagnosis, Cause::OverlapAtStart), "{diagnosis:#?}");
    let light = text_of("crossing-planes").replace("[1, 2000.0]", "[1, 0.2]");
    let Left { result, diagnosis } = run(&light);
    result.unwrap_or_else(|e| panic!("{e}"));
    assert!(diagnosis.is_none_or(|diagnosis| !names(&diagnosis, Cause::OverlapAtStart)));
}

/// What only general contact can hold is free before its layer is pressed; the load leads it there. What is pulled away is free for good.
#[test]
fn bodies_that_only_the_layer_can_hold() {
    let [block, tool] = ["held-by-the-layer", "tool-under-force"].map(text_of);
    [&block, &tool].into_iter().for_each(|text| comes_out_well(text));
    let Left { result, diagnosis } = run(&block.replace("[1, 9.0]", "[1, -9.0]"));
    let (error, diagnosis) = (result.unwrap_err().to_string(), diagnosis.unwrap());
    assert!(error.contains("the system is singular") && error.contains("smaller steps were not tried"), "{error}");
    is_cause(&diagnosis.findings[0], Cause::NoSupport);
    assert!(diagnosis.findings[0].sentence.contains("free to slide along z; contact supports it only"), "{diagnosis}");
    let Left { result, diagnosis } = run(&tool.replace("-20.0]", "20.0]"));
    assert!(result.is_err());
    let diagnosis = diagnosis.unwrap();
    is_cause(&diagnosis.findings[0], Cause::NoSupport);
    assert!(diagnosis.findings[0].remedies[0].text.starts_with("let contact close first"), "{diagnosis}");
}

/// A rigid motion that is free is a fact of the first matrix: one attempt, no smaller steps, and neither the message nor the remedies ask for them.
#[test]
fn a_free_motion_is_found_by_the_first_matrix() {
    for name in ["no-support", "free-rotation"] {
        let (_, diagnosis) = diagnosed(name);
        let sizes: Vec<f64> = diagnosis.attempts.iter().map(|attempt| attempt.dt).collect();
        assert!(sizes.iter().all(|dt| *dt == sizes[0]), "{name}: {sizes:?}");
        for part in ["smaller steps were not tried", "the system is singular"] {
            assert!(diagnosis.what.contains(part), "{name}: {}", diagnosis.what);
        }
        assert!(!diagnosis.what.contains("try smaller steps") && !diagnosis.what.contains("even at"), "{diagnosis}");
    }
}

/// A stage that lets go of a body is named first, with what it switches off; where a run stops in it, what the scene had from the start comes after.
#[test]
fn what_is_new_in_a_stage_is_named() {
    let stages = "[[stage]]\nname = \"hold\"\nkind = \"quasi-static\"\nuntil = 0.5\n[[stage]]\nname = \"let-go\"\nkind = \"quasi-static\"\nuntil = 1.0\noff = [\"grip\"]\n";
    let grip =
        "[[prescribe]]\nname = \"grip\"\nset = \"block.right\"\ncomponents = [\"x\", \"y\", \"z\"]\nfixed = true\n";
    let text = format!("{}{grip}{stages}", text_of("no-support"));
    let Left { result, diagnosis } = run(&text);
    let stopped = result.expect_err("nothing holds the block in the second stage");
    assert!(matches!(stopped, RunError::Simulation { last_time, .. } if (last_time - 0.5).abs() < 1e-9), "{stopped}");
    let diagnosis = diagnosis.unwrap();
    assert!(diagnosis.changes[0].contains("stage `let-go` begins, without `grip`"), "{:?}", diagnosis.changes);
    assert_eq!(diagnosis.findings[0].cause, Cause::NoSupport, "{diagnosis}");
}
