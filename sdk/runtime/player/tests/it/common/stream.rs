//! Cases for the player in C, in the format that `c/tests/cases.c` reads, and the results of this
//! crate's player.

use htex_player::{Block, OpenError, Player};

/// A block, and the calls to make with it.
pub struct Case {
    pub block: Vec<u8>,
    pub seed: u32,
    pub steps: Vec<Step>,
}

#[derive(Clone, Copy)]
pub enum Step {
    SetMotion(f32, f32),
    Render(usize),
    /// Samples as integers, with a full scale.
    RenderI16(usize, f32),
}

impl Step {
    fn words(self) -> [u32; 3] {
        match self {
            Self::SetMotion(speed, force) => [1, speed.to_bits(), force.to_bits()],
            Self::Render(count) => [2, count as u32, 0],
            Self::RenderI16(count, full_scale) => [3, count as u32, full_scale.to_bits()],
        }
    }
}

/// Writes cases as bytes.
pub fn encoded(cases: &[Case]) -> Vec<u8> {
    let mut bytes = (cases.len() as u32).to_le_bytes().to_vec();
    for case in cases {
        let steps = case.steps.iter().flat_map(|step| step.words());
        let head = [case.seed, case.steps.len() as u32].into_iter();
        let words = head.chain(steps).chain([case.block.len() as u32]);
        bytes.extend(words.flat_map(u32::to_le_bytes));
        bytes.extend(&case.block);
        bytes.resize(bytes.len().next_multiple_of(4), 0);
    }
    bytes
}

/// Returns a player's results for each case: the status of opening, the rate and the full scale,
/// the status and the level at each motion, and all samples.
pub fn expected(cases: &[Case]) -> Vec<Vec<u8>> {
    cases.iter().map(played).collect()
}

fn played(case: &Case) -> Vec<u8> {
    let block = match Block::open(&case.block) {
        Ok(block) => block,
        Err(error) => return status(error).to_le_bytes().to_vec(),
    };
    let mut player = Player::new(block, case.seed);
    let mut bytes = 0i32.to_le_bytes().to_vec();
    bytes.extend(block.rate_hz().to_le_bytes());
    bytes.extend(block.full_scale().to_le_bytes());
    for step in &case.steps {
        match *step {
            Step::SetMotion(speed, force) => {
                let refused = if player.set_motion(speed, force) { 0 } else { -2 };
                bytes.extend(i32::to_le_bytes(refused));
                bytes.extend(player.level().to_le_bytes());
            }
            Step::Render(count) => {
                let mut samples = vec![0.0; count];
                player.render(&mut samples);
                bytes.extend(samples.into_iter().flat_map(f32::to_le_bytes));
            }
            Step::RenderI16(count, full_scale) => {
                let mut samples = vec![0; count];
                player.render_i16(&mut samples, full_scale);
                bytes.extend(samples.into_iter().flat_map(i16::to_le_bytes));
            }
        }
    }
    bytes
}

/// The status code of the player in C.
fn status(error: OpenError) -> i32 {
    error as i32
}

/// FNV-1a hash of bytes.
pub fn hash(bytes: &[u8]) -> u32 {
    let add = |hash: u32, byte: &u8| (hash ^ u32::from(*byte)).wrapping_mul(0x0100_0193);
    bytes.iter().fold(0x811C_9DC5, add)
}
