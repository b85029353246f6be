//! `cargo xtask prove`: proofs that take too long for each run of continuous integration, which runs samples of them.

mod outputs;

/// A proof: its name, what it takes, what it proves, and how.
struct Proof {
    name: &'static str,
    takes: &'static str,
    proves: &'static str,
    prove: fn(&[&str]) -> Result<(), String>,
}

const PROOFS: &[Proof] = &[Proof {
    name: "outputs",
    takes: "[--htex PATH]",
    proves: "prints hashes of what the command writes and prints; `diff` compares them with those of another build",
    prove: outputs::prove,
}];

/// Runs the proof of a name; without one, lists all.
///
/// # Errors
/// What does not hold, or an unknown name.
pub fn prove(arguments: &[&str]) -> Result<(), String> {
    let Some((name, options)) = arguments.split_first() else {
        print!("{}", list());
        return Ok(());
    };
    let proof = PROOFS.iter().find(|proof| proof.name == *name);
    let proof = proof.ok_or_else(|| format!("no proof `{name}`; there are\n{}", list()))?;
    (proof.prove)(options)
}

fn list() -> String {
    let line = |proof: &Proof| format!("{} {}\n    {}\n", proof.name, proof.takes, proof.proves);
    PROOFS.iter().map(line).collect()
}
