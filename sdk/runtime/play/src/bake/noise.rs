//! Designs the noise filters of the conditions. Each filter is designed only once and then cached.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;

use htex_host::Band;

use crate::Error;
use crate::bake::compress::Factors;
use crate::bake::filter::{Bins, Design, Target};
use crate::bake::moments::{Moment, Moments};

/// The centre and one side of a filter with unit energy.
pub(crate) type Filter = Rc<Vec<f64>>;

/// Designs filters at one rate and measures their spectra. Caches both.
pub(crate) struct Designer {
    band: Band,
    design: RefCell<Design>,
    /// Bins. The key is the bits of the ratio of their frequencies.
    bins: RefCell<BTreeMap<u64, Rc<Bins>>>,
    /// Filters. The key is their length and all values that determine the spectrum.
    filters: RefCell<BTreeMap<(usize, Vec<u64>), Filter>>,
}

impl Designer {
    pub(crate) fn new(design: Design, band: Band) -> Self {
        Self {
            band,
            design: RefCell::new(design),
            bins: RefCell::default(),
            filters: RefCell::default(),
        }
    }

    /// Returns whether this designer uses the given design.
    pub(crate) fn is_of(&self, design: &Design) -> bool {
        self.design.borrow().is_same(design)
    }

    fn bins(&self, ratio: f64) -> Rc<Bins> {
        let mut known = self.bins.borrow_mut();
        let bins = known.entry(ratio.to_bits());
        let new = || Rc::new(Bins::new(&self.design.borrow(), self.band, ratio));
        Rc::clone(bins.or_insert_with(new))
    }

    /// Returns the filter for a moment, with `half` coefficients on each side.
    pub(crate) fn filter(
        &self,
        texture: &Moments<'_>,
        moment: &Moment,
        half: usize,
    ) -> Result<Filter, Error> {
        let key = (half, moment.shape());
        if let Some(known) = self.filters.borrow().get(&key) {
            return Ok(Rc::clone(known));
        }
        // The function `bins` itself borrows the design, so it is called before the design is
        // borrowed for writing.
        let bins = self.bins(moment.ratio);
        let mut design = self.design.borrow_mut();
        let played = design.frequencies_hz().into_iter();
        let recorded: Vec<f64> = played.map(|hz| hz / moment.ratio).collect();
        let wanted = Target {
            magnitude: texture.magnitude(moment, &recorded)?,
            stated: &moment.stated,
            bands: texture.bands(),
        };
        let filter = Rc::new(design.filter(&wanted, &bins, half));
        self.filters.borrow_mut().insert(key, Rc::clone(&filter));
        Ok(filter)
    }

    /// Returns the magnitude of filtered white noise of unit variance at the bins. The frequencies
    /// of the bins are multiplied by `ratio`.
    pub(crate) fn read(&self, side: &[f64], ratio: f64) -> Vec<f64> {
        // This is a separate statement, so that the borrow ends before `bins` needs the design.
        let response = self.design.borrow_mut().response(side);
        self.bins(ratio).read(&response)
    }

    /// Finds at most `most` common filters, so that each condition's filter is a weighted sum of
    /// them. `slowest` and `fastest` are the smallest and the largest factor of the band's
    /// frequencies.
    pub(crate) fn factors(
        &self,
        conditions: &[&[f64]],
        slowest: f64,
        fastest: f64,
        most: usize,
    ) -> Factors {
        let hz = slowest * self.band.low_hz..=fastest * self.band.high_hz;
        Factors::new(&mut self.design.borrow_mut(), conditions, hz, most)
    }
}
