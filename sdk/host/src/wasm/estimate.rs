//! How long compiling a module takes at most, found out before it is compiled.
//!
//! The compiler's time and memory grow faster than a module: with the operators of one function, with values that live
//! across branches or join where blocks end, and with blocks within blocks. Each of these is a term here. The sum is a
//! bound, within a factor of three for the modules it was compared with, and no guess at what is usual.

use wasmparser::{
    BinaryReaderError, FuncValidator, FunctionBody, Operator, OperatorsReader, Parser, Payload,
    ValidPayload, Validator, ValidatorResources, WasmFeatures,
};

/// Times that compiling a module takes at most, microseconds.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Estimate {
    /// With everything the compiler can do for the speed of the code.
    pub(super) optimised_us: f64,
    /// With what takes a time proportional to the module, nearly.
    pub(super) quick_us: f64,
}

/// Estimates how long a module is compiled.
///
/// # Errors
/// When it is no valid module of WebAssembly 2.0, which is what models may use (specification of the model ABI,
/// section 7).
pub(super) fn estimate(module: &[u8]) -> Result<Estimate, String> {
    let wrong = |e: BinaryReaderError| format!("no valid module: {e}");
    let mut validator = Validator::new_with_features(WasmFeatures::WASM2);
    let mut all = Estimate::default();
    for payload in Parser::new(0).parse_all(module) {
        let payload = payload.map_err(wrong)?;
        all.add(section_us(&payload));
        if let ValidPayload::Func(function, body) = validator.payload(&payload).map_err(wrong)? {
            let function = function.into_validator(Default::default());
            let one = function_us(function, &body).map_err(wrong)?;
            all.optimised_us += one.optimised_us;
            all.quick_us += one.quick_us;
        }
    }
    Ok(all)
}

/// What the entries of a section take.
fn section_us(section: &Payload<'_>) -> f64 {
    match section {
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
        cost.add(&operator, &function);
        function.op(at, &operator)?;
    }
    operators.finish()?;
    Ok(cost.estimate())
}

/// The cost of a function as far as its operators were seen.
struct Cost {
    us: Estimate,
    locals: f64,
    operators: f64,
    blocks: f64,
    /// Values that may differ between the ways to a place where ways join, over all ways.
    joined: f64,
    /// The blocks around the operator, the function itself first.
    around: Vec<Block>,
}

/// A block that is not at its end yet.
struct Block {
    is_loop: bool,
    /// Ways to the place where those to this block join: its end, or the head of a loop.
    ways: f64,
    /// Assignments to locals within it.
    assigned: f64,
}

impl Cost {
    fn new(locals: f64) -> Self {
        let mut us = Estimate::default();
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
                all.chain([targets.default()])
                    .for_each(|to| self.branch(to, live));
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

    /// Where ways join, a local that was assigned in between may have another value on each.
    fn leave(&mut self) {
        let Some(block) = self.around.pop() else {
            return;
        };
        self.joined += block.ways * block.assigned.min(self.locals);
        if let Some(outer) = self.around.last_mut() {
            outer.assigned += block.assigned;
        }
    }

    /// Takes along what the loop that it goes to may change.
    fn branch(&mut self, relative_depth: u32, live: f64) {
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
        Self {
            is_loop,
            ways,
            assigned: 0.0,
        }
    }
}

impl Estimate {
    fn add(&mut self, us: f64) {
        self.optimised_us += us;
        self.quick_us += us;
    }
}

/// What an operator takes beyond a simple one, microseconds.
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

    /// A function of a hundred blocks within one another, each with assignments and with branches to blocks further
    /// out, took 1.25 s of a processor's time to compile with all optimisations.
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
        assert!(
            optimised_us.clone().is_ok_and(|us| us > 0.5 * 1.25e6),
            "{optimised_us:?}"
        );
    }
}
