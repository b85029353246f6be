//! Small WASM functions that take a long time to compile.

/// A function: nested blocks, with statements at the head and at the end of each.
#[derive(Debug, Clone, Default)]
pub(crate) struct Heavy {
    /// Local variables, 64-bit integers.
    pub locals: usize,
    /// Nesting depth of blocks.
    pub depth: usize,
    /// Number of consecutive nests.
    pub nests: usize,
    /// Number of copies of the function.
    pub copies: usize,
    /// Kinds of the blocks, used in turn: a block, a loop, an `if`.
    pub blocks: Vec<u8>,
    /// Statements at the head of each block, as numbers in [`Heavy::statement`].
    pub head: Vec<u8>,
    /// Statements at the end of each block.
    pub end: Vec<u8>,
}

/// Number of kinds of statements.
const KINDS: u8 = 14;

impl Heavy {
    /// Returns the text of the functions and of the items they use, for a module with a memory.
    pub(crate) fn text(&self) -> String {
        let mut function = String::new();
        let mut n = 0;
        for _ in 0..self.nests {
            for at in 0..self.depth {
                function += match self.blocks.get(at % self.blocks.len().max(1)).unwrap_or(&0) % 3 {
                    0 => "(block",
                    1 => "(loop",
                    _ => "(if (local.get 0) (then",
                };
                self.statements(&self.head, &mut n, at + 1, &mut function);
            }
            for at in (0..self.depth).rev() {
                self.statements(&self.end, &mut n, at + 1, &mut function);
                function += match self.blocks.get(at % self.blocks.len().max(1)).unwrap_or(&0) % 3 {
                    2 => "))",
                    _ => ")",
                };
            }
        }
        // Uses every variable.
        for local in 1..=self.locals {
            function += &format!("(i64.store (i32.const 0) (local.get {local}))");
        }
        let locals = " i64".repeat(self.locals);
        let function = format!("(func (param i32) (local{locals}) {function})\n");
        format!(
            "(type $any (func (param i32) (result i32)))
             (table $table 2 2 funcref)
             (func $called (param i32) (result i32) (local.get 0))
             {}",
            function.repeat(self.copies)
        )
    }

    fn statements(&self, kinds: &[u8], n: &mut usize, depth: usize, text: &mut String) {
        for kind in kinds {
            *n += 1;
            *text += &self.statement(*kind, *n, depth);
        }
    }

    /// Returns the `n`th statement, at a nesting depth. No two of a kind are equal.
    fn statement(&self, kind: u8, n: usize, depth: usize) -> String {
        let local = |n: usize| 1 + n % self.locals.max(1);
        let (to, from) = (local(n), local(n * 7 + 3));
        let outermost = depth - 1;
        match kind % KINDS {
            0 => format!("(local.set {to} (i64.add (local.get {to}) (i64.const {n})))"),
            1 => format!("(local.set {to} (i64.xor (local.get {to}) (local.get {from})))"),
            2 => format!("(br_if {} (local.get 0))", n % depth),
            3 => format!("(br_if {outermost} (local.get 0))"),
            4 => "(br_if 0 (local.get 0))".to_owned(),
            5 => {
                let all: Vec<String> = (0..depth).map(|to| to.to_string()).collect();
                format!("(br_table {} (local.get 0))", all.join(" "))
            }
            6 => "(local.set 0 (call $called (local.get 0)))".to_owned(),
            7 => "(local.set 0 (call_indirect (type $any) (local.get 0) (local.get 0)))".to_owned(),
            8 => format!("(memory.copy (i32.const {n}) (local.get 0) (i32.const 8))"),
            9 => "(local.set 0 (memory.grow (local.get 0)))".to_owned(),
            10 => format!("(local.set {to} (i64.load (i32.const {})))", n % 60_000),
            11 => format!("(local.set {to} (i64.div_u (local.get {from}) (i64.const {n})))"),
            12 => {
                format!("(local.set {to} (i64.trunc_f64_s (f64.convert_i64_s (local.get {from}))))")
            }
            _ => "(table.copy (local.get 0) (local.get 0) (local.get 0))".to_owned(),
        }
    }

    /// Whether the text has a practical size.
    pub(crate) fn is_bounded(&self) -> bool {
        let blocks = self.depth * self.nests;
        let each = 1 + self.head.len() + self.end.len();
        let targets = self.head.iter().chain(&self.end).filter(|k| **k % KINDS == 5).count();
        blocks * (each + targets * self.depth) + self.locals * self.copies <= 60_000
            && self.copies * (blocks * each + self.locals) <= 60_000
    }
}
