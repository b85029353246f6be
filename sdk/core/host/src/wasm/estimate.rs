//! Estimates, before the compilation of a module begins, how long it will take. The estimate is an
//! upper bound.
//!
//! The compiler's time and memory can grow faster than the size of the module. This has three
//! possible reasons: functions have many operators, values stay live across branches or merge at
//! the ends of blocks, or blocks are nested. The estimate is a sum with one term for each of these
//! reasons. In a comparison with measured times, the sum was above the measured time of every
//! module, and at most three times the measured time.
//!
//! If the estimate of a module exceeds the limit, the host compiles the module without optimisation
//! and with a single-pass register allocator ([`super::engine::Effort::Quick`]), which takes nearly
//! linear time. If the estimate for this quick compilation also exceeds the limit, the host refuses
//! the module.

use wasmparser::{
    BinaryReaderError, FuncValidator, FunctionBody, Operator, OperatorsReader, Parser, Payload,
    ValidPayload, Validator, ValidatorResources, WasmFeatures,
};

use super::compile_error::CompileError;

/// Upper bounds of a module's compilation time, microseconds.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Estimate {
    /// Time with all optimisations.
    pub(super) optimised_us: f64,
    /// Time with only the steps whose time is nearly proportional to the module's size.
    pub(super) quick_us: f64,
}

/// Estimates the compilation time of a module.
///
/// # Errors
/// If the bytes are not a valid module of WebAssembly 2.0, the version that models may use (section
/// 7 of the specification of the model ABI).
pub(super) fn estimate(module: &[u8]) -> Result<Estimate, CompileError> {
    let mut validator = Validator::new_with_features(WasmFeatures::WASM2);
    let mut all = Estimate::default();
    for payload in Parser::new(0).parse_all(module) {
        let payload = payload?;
        all.add(section_us(&payload));
        if let ValidPayload::Func(function, body) = validator.payload(&payload)? {
            let function = function.into_validator(Default::default());
            let one = function_us(function, &body)?;
            all.optimised_us += one.optimised_us;
            all.quick_us += one.quick_us;
        }
    }
    Ok(all)
}

/// Returns the time of a section's entries, microseconds.
fn section_us(section: &Payload<'_>) -> f64 {
    match section {
        // All coefficients in this file are microseconds, measured on one machine. `SLOWER` in
        // `compile.rs` allows for slower machines.
        Payload::TypeSection(s) => 25.0 * f64::from(s.count()) + s.range().len() as f64,
        Payload::GlobalSection(s) => f64::from(s.count()),
        Payload::ExportSection(s) => f64::from(s.count()),
        Payload::DataSection(s) => f64::from(s.count()),
        Payload::ElementSection(s) => s.range().len() as f64,
        _ => 0.0,
    }
}

fn function_us(
    mut function: FuncValidator<ValidatorResources>,
    body: &FunctionBody<'_>,
) -> Result<Estimate, BinaryReaderError> {
    let mut reader = body.get_binary_reader();
    function.read_locals(&mut reader)?;
    reader.set_features(WasmFeatures::WASM2);
    let mut operators = OperatorsReader::new(reader);
    let mut cost = Cost::new(f64::from(function.len_locals()));
    while !operators.eof() {
        let (operator, at) = operators.read_with_offset()?;
        // The operator is counted before the validator processes it, because the validator's stack
        // is then still the stack before the operator. Therefore, an operator that is counted here
        // may be invalid.
        cost.add(&operator, &function);
        function.op(at, &operator)?;
    }
    operators.finish()?;
    Ok(cost.estimate())
}

/// The accumulated cost of a function's operators.
struct Cost {
    us: Estimate,
    locals: f64,
    operators: f64,
    blocks: f64,
    /// Number of values that may differ between the paths to a merge point. Each value counts once
    /// for each path.
    joined: f64,
    /// The blocks that contain the current operator, from the function's body inwards.
    around: Vec<Block>,
}

/// A block whose end has not been read yet.
struct Block {
    is_loop: bool,
    /// Number of paths to the block's merge point: its end, or the head of a loop.
    ways: f64,
    /// Number of assignments to locals within the block.
    assigned: f64,
}

impl Cost {
    fn new(locals: f64) -> Self {
        let mut us = Estimate::default();
        // Even an empty function takes time, and a module may have very many functions.
        us.add(40.0 + 0.1 * locals);
        Self {
            us,
            locals,
            operators: 0.0,
            blocks: 0.0,
            joined: 0.0,
            around: vec![Block::new(false, 1.0)],
        }
    }

    fn add(&mut self, operator: &Operator<'_>, function: &FuncValidator<ValidatorResources>) {
        let (takes, gives) = operator.operator_arity(function).unwrap_or_default();
        let passed = f64::from(takes) + f64::from(gives);
        let live = 8.0 + self.locals + f64::from(function.operand_stack_height());
        self.operators += 1.0;
        self.us.add(more_us(operator));
        if passed > 4.0 {
            self.us.add(5.0 * passed);
        }
        match operator {
            Operator::Loop { .. } => self.enter(Block::new(true, 1.0), live, passed),
            Operator::Block { .. } => self.enter(Block::new(false, 1.0), live, passed),
            Operator::If { .. } => self.enter(Block::new(false, 2.0), live, passed),
            Operator::End => self.leave(),
            Operator::LocalSet { .. } | Operator::LocalTee { .. } => {
                if let Some(block) = self.around.last_mut() {
                    block.assigned += 1.0;
                }
            }
            Operator::Br { relative_depth } | Operator::BrIf { relative_depth } => {
                self.branch(*relative_depth, live)
            }
            Operator::BrTable { targets } => {
                let all = targets.targets().flatten();
                all.chain([targets.default()]).for_each(|to| self.branch(to, live));
            }
            _ => {}
        }
    }

    fn enter(&mut self, block: Block, live: f64, passed: f64) {
        let (depth, is_loop) = (self.around.len() as f64, block.is_loop);
        self.around.push(block);
        self.blocks += 1.0;
        if passed > 1.0 {
            self.us.add(0.5 * passed * self.blocks);
        }
        if is_loop {
            self.us.add(depth / 30.0 + self.blocks / 1000.0);
        }
        let loop_more = if is_loop { 0.5 } else { 0.0 };
        self.us.optimised_us += live * (0.1 + loop_more + 0.03 * depth + 0.0004 * depth * depth);
        self.us.quick_us += live * (0.7 + 0.00005 * depth);
    }

    /// Leaves a block. At its merge point, a local that was assigned in the block may have a
    /// different value on each path.
    fn leave(&mut self) {
        let Some(block) = self.around.pop() else {
            return;
        };
        self.joined += block.ways * block.assigned.min(self.locals);
        if let Some(outer) = self.around.last_mut() {
            outer.assigned += block.assigned;
        }
    }

    /// Adds a branch. If it is a branch to a loop, all live values merge at the head of the loop.
    fn branch(&mut self, relative_depth: u32, live: f64) {
        // The branch has not been validated yet, so its depth may be too large.
        let at = self.around.len().checked_sub(1 + relative_depth as usize);
        let target = at.and_then(|at| self.around.get_mut(at));
        let to_loop = target.is_some_and(|block| {
            block.ways += 1.0;
            block.is_loop
        });
        self.us.add(0.5);
        self.us.optimised_us += live * if to_loop { 1.0 } else { 0.02 };
        self.us.quick_us += live * if to_loop { 0.3 } else { 0.02 };
    }

    fn estimate(self) -> Estimate {
        // Without optimisation the time is nearly linear, so the quick estimate has no quadratic
        // terms.
        let n = self.operators;
        Estimate {
            optimised_us: self.us.optimised_us
                + 2.0 * n
                + n * n / 400.0
                + self.joined * self.joined / 4000.0,
            quick_us: self.us.quick_us + 3.0 * n,
        }
    }
}

impl Block {
    fn new(is_loop: bool, ways: f64) -> Self {
        Self { is_loop, ways, assigned: 0.0 }
    }
}

impl Estimate {
    fn add(&mut self, us: f64) {
        self.optimised_us += us;
        self.quick_us += us;
    }
}

/// Returns the time that an operator takes in addition to the time of a simple operator,
/// microseconds.
fn more_us(operator: &Operator<'_>) -> f64 {
    use Operator as O;
    match operator {
        O::TableCopy { .. } | O::TableFill { .. } | O::TableInit { .. } | O::TableGrow { .. } => {
            170.0
        }
        O::CallIndirect { .. }
        | O::MemoryGrow { .. }
        | O::MemoryCopy { .. }
        | O::MemoryFill { .. }
        | O::MemoryInit { .. }
        | O::TableGet { .. }
        | O::TableSet { .. }
        | O::RefFunc { .. }
        | O::DataDrop { .. }
        | O::ElemDrop { .. } => 45.0,
        O::Call { .. } => 3.0,
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The function has a hundred nested blocks. Each block has assignments, and branches to outer
    /// blocks. Compiling it with all optimisations took 1.25 s of processor time.
    #[test]
    fn branches_out_of_nested_blocks_take_long() {
        let (mut body, mut n) = (String::new(), 0);
        for depth in 1..=100 {
            body += "(if (local.get 0) (then";
            for _ in 0..4 {
                n += 1;
                body += &format!("(br_if {} (local.get 0))", n % depth);
            }
            for _ in 0..4 {
                n += 1;
                let local = 1 + n % 100;
                body +=
                    &format!("(local.set {local} (i64.add (local.get {local}) (i64.const {n})))");
            }
        }
        body += &"))".repeat(100);
        for local in 1..=100 {
            body += &format!("(i64.store (i32.const 0) (local.get {local}))");
        }
        let locals = " i64".repeat(100);
        let text = format!("(module (memory 1) (func (param i32) (local{locals}) {body}))");
        let module = wat::parse_str(text).unwrap_or_default();
        let optimised_us = estimate(&module).map(|found| found.optimised_us);
        assert!(optimised_us.clone().is_ok_and(|us| us > 0.5 * 1.25e6), "{optimised_us:?}");
    }
}
