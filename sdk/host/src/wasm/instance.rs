//! One instance of a module: its functions, and a room in its memory for what is passed.

use std::sync::Arc;
use std::time::{Duration, Instant};

use wasmtime::{Instance as Raw, Memory, Store, TypedFunc, WasmParams, WasmResults};

use super::allowance::Allowance;
use super::fault::Fault;
use super::module::WasmModule;
use super::usage::Usage;

/// Addresses and lengths in the module's memory.
type Usize = u32;

/// The functions of the model ABI, as `htex_model::abi` has them.
pub(super) struct Functions {
    pub(super) abi_version: TypedFunc<(), u32>,
    pub(super) descriptor: TypedFunc<(Usize, Usize), i64>,
    pub(super) last_error: TypedFunc<(Usize, Usize), i64>,
    pub(super) fit: TypedFunc<FitParams, i64>,
    pub(super) magnitude: TypedFunc<MagnitudeParams, i64>,
    pub(super) interpolate: TypedFunc<(Usize, Usize, Usize, Usize, Usize, Usize), i64>,
    pub(super) voice_rate: TypedFunc<(Usize, Usize, f64, f64, f64), f64>,
    pub(super) voice_new: TypedFunc<(Usize, Usize, f64, f64, f64, u64), i64>,
    pub(super) voice_render: TypedFunc<(i64, Usize, Usize), i64>,
    pub(super) voice_retune: TypedFunc<(i64, Usize, Usize), i64>,
    pub(super) voice_free: TypedFunc<i64, i64>,
    pub(super) extension: TypedFunc<(Usize, Usize), i64>,
    /// Where the model has the extension `htex.motion/1`.
    pub(super) motion: Option<MotionFunctions>,
    alloc: TypedFunc<Usize, Usize>,
    free: TypedFunc<(Usize, Usize), ()>,
}

/// The functions of `htex.motion/1`, as `htex_model::motion_1` has them.
pub(super) struct MotionFunctions {
    pub(super) set: TypedFunc<(i64, f64, f64, f64), i64>,
    pub(super) fit: TypedFunc<MotionFitParams, i64>,
}

type FitParams = (
    f64,
    f64,
    Usize,
    Usize,
    Usize,
    Usize,
    Usize,
    f64,
    Usize,
    Usize,
    Usize,
    Usize,
    Usize,
);

type MotionFitParams = (
    f64,
    f64,
    Usize,
    Usize,
    Usize,
    Usize,
    Usize,
    f64,
    Usize,
    Usize,
    f64,
    f64,
    Usize,
    Usize,
    Usize,
);

type MagnitudeParams = (Usize, Usize, f64, f64, Usize, Usize, Usize);

/// An instance, alone in its store.
pub(super) struct Instance {
    module: Arc<WasmModule>,
    store: Store<Usage>,
    memory: Memory,
    functions: Functions,
    /// The time of a voice; other calls take theirs of the modules' budget.
    allowance: Option<Allowance>,
    /// Where the room is, and its length; nowhere at first.
    room: (Usize, Usize),
}

/// How long a call may take.
#[derive(Clone, Copy)]
pub(super) enum Deadline {
    Call,
    Render,
}

impl Instance {
    /// Makes an instance, which runs the module's start function.
    pub(super) fn new(module: &Arc<WasmModule>) -> Result<Self, Fault> {
        let limits = &module.limits;
        let usage = Usage::new(limits, &module.budget).map_err(Fault)?;
        let mut store = Store::new(&module.engine.engine, usage);
        store.limiter(|usage| usage);
        let time = limits.call.min(module.budget.time_left().map_err(Fault)?);
        let fault = |e| Fault::of(&e, limits, time.as_millis());
        arm(&mut store, module, time).map_err(fault)?;
        let start = Instant::now();
        let raw = Raw::new(&mut store, &module.module, &[]);
        module.budget.spend(start.elapsed());
        let raw = raw.map_err(|e| Fault(format!("at its start: {}", fault(e).0)))?;
        let memory = raw
            .get_memory(&mut store, "memory")
            .ok_or_else(|| Fault("the module exports no `memory`".to_owned()))?;
        Ok(Self {
            module: Arc::clone(module),
            functions: Functions::of(&mut store, &raw, module.follows_motion())?,
            store,
            memory,
            allowance: None,
            room: (0, 0),
        })
    }

    /// From now on this is a voice, which renders at a rate and has its own time.
    pub(super) fn be_a_voice(&mut self, rate_hz: f64) {
        self.allowance = Some(Allowance::new(rate_hz));
    }

    /// Adds the time of samples that were rendered.
    pub(super) fn earn(&mut self, samples: usize) {
        if let Some(allowance) = &mut self.allowance {
            allowance.earn(samples);
        }
    }

    /// The time that this instance may take.
    fn time_left(&self) -> Result<Duration, String> {
        match &self.allowance {
            Some(allowance) => allowance.left(),
            None => self.module.budget.time_left(),
        }
    }

    fn spend(&mut self, time: Duration) {
        match &mut self.allowance {
            Some(allowance) => allowance.spend(time),
            None => self.module.budget.spend(time),
        }
    }

    /// Calls one of the functions within the deadline.
    pub(super) fn call<P: WasmParams, R: WasmResults>(
        &mut self,
        deadline: Deadline,
        function: impl Fn(&Functions) -> &TypedFunc<P, R>,
        parameters: P,
    ) -> Result<R, Fault> {
        self.call_if(deadline, |functions| Some(function(functions)), parameters)
    }

    /// As [`Self::call`], of a function that only some models have.
    pub(super) fn call_if<P: WasmParams, R: WasmResults>(
        &mut self,
        deadline: Deadline,
        function: impl Fn(&Functions) -> Option<&TypedFunc<P, R>>,
        parameters: P,
    ) -> Result<R, Fault> {
        let most = match deadline {
            Deadline::Call => self.module.limits.call,
            Deadline::Render => self.module.limits.render,
        };
        let time = most.min(self.time_left().map_err(Fault)?);
        let Some(function) = function(&self.functions) else {
            return Err(Fault(
                "the module has not the extension of this call".to_owned(),
            ));
        };
        let start = Instant::now();
        let result = arm(&mut self.store, &self.module, time)
            .and_then(|()| function.call(&mut self.store, parameters));
        self.spend(start.elapsed());
        result.map_err(|e| match self.time_left() {
            Err(used_up) => Fault(format!("the module was stopped: {used_up}")),
            Ok(_) => Fault::of(&e, &self.module.limits, time.as_millis()),
        })
    }

    /// Whether the module has the extension `htex.motion/1`.
    pub(super) fn follows_motion(&self) -> bool {
        self.functions.motion.is_some()
    }

    /// Size of the module's memory, bytes.
    pub(super) fn memory_bytes(&self) -> usize {
        self.memory.data_size(&self.store)
    }

    /// The address of a room of at least `bytes`, a multiple of 8, in the module's memory. It stays
    /// where it is until a larger one is asked for.
    pub(super) fn room(&mut self, bytes: usize) -> Result<Usize, Fault> {
        if bytes <= self.room.1 as usize {
            return Ok(self.room.0);
        }
        let too_much = || {
            let most = self.module.limits.memory_bytes;
            Fault(format!(
                "a call passes {bytes} bytes; the module's memory is limited to {most}"
            ))
        };
        let bytes = bytes.next_power_of_two();
        let fits = bytes <= self.module.limits.memory_bytes;
        let len = Usize::try_from(bytes).ok().filter(|_| fits);
        let len = len.ok_or_else(too_much)?;
        let old = std::mem::take(&mut self.room);
        if old.1 > 0 {
            self.call(Deadline::Call, |f| &f.free, old)?;
        }
        let at = self.call(Deadline::Call, |f| &f.alloc, len)?;
        let inside = u64::from(at) + u64::from(len) <= self.memory.data_size(&self.store) as u64;
        if at == 0 || at % 8 != 0 || !inside {
            return Err(Fault(format!(
                "`htex_model_alloc` answered {at:#x} for {len} bytes, which is no usable room in \
                 the module's memory"
            )));
        }
        self.room = (at, len);
        Ok(at)
    }

    /// Writes numbers at an address; answers the one behind them.
    pub(super) fn write(&mut self, at: Usize, numbers: &[f64]) -> Result<Usize, Fault> {
        let bytes = self.bytes_mut(at, numbers.len() * 8)?;
        for (to, x) in bytes.chunks_exact_mut(8).zip(numbers) {
            to.copy_from_slice(&x.to_le_bytes());
        }
        Ok(at + (numbers.len() * 8) as Usize)
    }

    /// Writes a text at an address.
    pub(super) fn write_text(&mut self, at: Usize, text: &[u8]) -> Result<(), Fault> {
        self.bytes_mut(at, text.len())?.copy_from_slice(text);
        Ok(())
    }

    /// Reads numbers at an address.
    pub(super) fn read(&self, at: Usize, numbers: &mut [f64]) -> Result<(), Fault> {
        let bytes = self.bytes(at, numbers.len() * 8)?;
        for (x, from) in numbers.iter_mut().zip(bytes.as_chunks().0) {
            *x = f64::from_le_bytes(*from);
        }
        Ok(())
    }

    /// Reads samples at an address.
    pub(super) fn read_samples(&self, at: Usize, samples: &mut [f32]) -> Result<(), Fault> {
        let bytes = self.bytes(at, samples.len() * 4)?;
        for (x, from) in samples.iter_mut().zip(bytes.as_chunks().0) {
            *x = f32::from_le_bytes(*from);
        }
        Ok(())
    }

    /// The bytes at an address.
    pub(super) fn bytes(&self, at: Usize, len: usize) -> Result<&[u8], Fault> {
        let data = self.memory.data(&self.store);
        data.get(at as usize..)
            .and_then(|rest| rest.get(..len))
            .ok_or_else(outside)
    }

    fn bytes_mut(&mut self, at: Usize, len: usize) -> Result<&mut [u8], Fault> {
        let data = self.memory.data_mut(&mut self.store);
        data.get_mut(at as usize..)
            .and_then(|rest| rest.get_mut(..len))
            .ok_or_else(outside)
    }
}

fn outside() -> Fault {
    Fault("what is passed lies outside the module's memory".to_owned())
}

/// Gives the next call its time and its instructions.
fn arm(store: &mut Store<Usage>, module: &WasmModule, time: Duration) -> wasmtime::Result<()> {
    store.set_epoch_deadline(module.engine.ticks(time));
    match module.limits.fuel {
        Some(fuel) => store.set_fuel(fuel),
        None => Ok(()),
    }
}

impl Functions {
    fn of(store: &mut Store<Usage>, raw: &Raw, motion: bool) -> Result<Self, Fault> {
        let motion = motion
            .then(|| MotionFunctions::of(store, raw))
            .transpose()?;
        Ok(Self {
            motion,
            abi_version: get(store, raw, "htex_model_abi_version")?,
            descriptor: get(store, raw, "htex_model_descriptor")?,
            last_error: get(store, raw, "htex_model_last_error")?,
            fit: get(store, raw, "htex_model_fit")?,
            magnitude: get(store, raw, "htex_model_magnitude")?,
            interpolate: get(store, raw, "htex_model_interpolate")?,
            voice_rate: get(store, raw, "htex_model_voice_rate")?,
            voice_new: get(store, raw, "htex_model_voice_new")?,
            voice_render: get(store, raw, "htex_model_voice_render")?,
            voice_retune: get(store, raw, "htex_model_voice_retune")?,
            voice_free: get(store, raw, "htex_model_voice_free")?,
            extension: get(store, raw, "htex_model_extension")?,
            alloc: get(store, raw, "htex_model_alloc")?,
            free: get(store, raw, "htex_model_free")?,
        })
    }
}

impl MotionFunctions {
    fn of(store: &mut Store<Usage>, raw: &Raw) -> Result<Self, Fault> {
        Ok(Self {
            set: get(store, raw, "htex_motion_1_set")?,
            fit: get(store, raw, "htex_motion_1_fit")?,
        })
    }
}

fn get<P: WasmParams, R: WasmResults>(
    store: &mut Store<Usage>,
    raw: &Raw,
    name: &str,
) -> Result<TypedFunc<P, R>, Fault> {
    let function = raw.get_func(&mut *store, name);
    let function = function.ok_or_else(|| {
        Fault(format!(
            "the module exports no function `{name}`; it is no htex model"
        ))
    })?;
    function.typed(store).map_err(|e| {
        Fault(format!(
            "`{name}` has not the arguments of the model ABI: {e:#}"
        ))
    })
}
