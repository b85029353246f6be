//! Model files like the toolkit's, generated from a seed.

pub mod busy;

use htex_dsp::line_spectrum::line_spectral_frequencies;
use htex_dsp::linear_prediction::reflection_to_coefficients;
use htex_dsp::uniform::Uniform;

/// Number of columns and rows in the grid of motions.
const COLUMNS: usize = 8;
const ROWS: usize = 5;

/// A filter at one motion. Its polynomials begin with 1.
#[derive(Debug)]
pub struct Model {
    pub ar: Vec<f64>,
    pub ma: Vec<f64>,
    pub variance: f64,
    pub gain: f64,
    pub speed: f64,
    pub force: f64,
}

/// Generates forty models. They are silent where the tool does not move or press, and have a zero
/// next to the Nyquist frequency, like the toolkit's.
pub fn draw(seed: u64, poles: usize, zeros: usize) -> Vec<Model> {
    let mut uniform = Uniform::new(seed);
    let mut within = |low: f64, high: f64| low + (high - low) * uniform.next_unit();
    let mut models = Vec::new();
    for row in 0..ROWS {
        for column in 0..COLUMNS {
            let bend =
                0.2 * f64::from(u8::from(row % (ROWS - 1) != 0 && column % (COLUMNS - 1) != 0));
            let place = |at: usize, of: usize, moved: f64| (at as f64 + moved) / (of as f64 - 1.0);
            let speed = 242.346_758 * place(column, COLUMNS, within(-bend, bend));
            let force = 6.558_225 * place(row, ROWS, within(-bend, bend));
            let is_audible = row > 0 && column > 0;
            models.push(Model {
                ar: polynomial(poles, &mut within, None),
                ma: polynomial(zeros, &mut within, Some(0.999_99)),
                variance: if is_audible { within(0.001, 0.2) } else { 0.0 },
                gain: within(1.5, 40.0),
                speed: rounded(speed),
                force: rounded(force),
            });
        }
    }
    models
}

/// A number as rounded in the file.
fn rounded(x: f64) -> f64 {
    format!("{x:.6}").parse().unwrap()
}

/// A polynomial with its zeros inside the circle. If a radius is given, the last zero lies at minus
/// that radius.
fn polynomial(
    order: usize,
    within: &mut impl FnMut(f64, f64) -> f64,
    radius: Option<f64>,
) -> Vec<f64> {
    let free = order.saturating_sub(usize::from(radius.is_some()));
    let reflection: Vec<f64> =
        (0..free).map(|i| within(-0.8, 0.8) / (1.0 + 0.2 * i as f64)).collect();
    let mut made = vec![1.0];
    made.extend(reflection_to_coefficients(&reflection).iter().map(|a| -a));
    if let Some(radius) = radius.filter(|_| order > 0) {
        let before = made.clone();
        made.push(0.0);
        for (b, previous) in made.iter_mut().skip(1).zip(before) {
            *b += radius * previous;
        }
    }
    made
}

/// A file with forty models, and two triangles in each cell of their grid.
pub fn file(models: &[Model]) -> String {
    let values = |values: &mut dyn Iterator<Item = String>| -> String {
        values.map(|x| format!("<value>{x}</value>")).collect()
    };
    let decimals =
        |all: &[f64], digits: usize| values(&mut all.iter().map(|x| format!("{x:.digits$}")));
    let lines = |polynomial: &[f64]| {
        let negated: Vec<f64> = polynomial[1..].iter().map(|b| -b).collect();
        decimals(&line_spectral_frequencies(&negated).unwrap_or_default(), 6)
    };
    let mut triangles = String::new();
    for corner in
        (0..ROWS - 1).flat_map(|row| (1..COLUMNS).map(move |column| row * COLUMNS + column))
    {
        let (right, above) = (corner + 1, corner + COLUMNS);
        for three in [[corner, right, above], [above + 1, above, right]] {
            let corners = values(&mut three.iter().map(ToString::to_string));
            triangles += &format!("<tri type=\"array\">{corners}</tri>\n");
        }
    }
    let lists = |of: fn(&Model) -> f64| decimals(&models.iter().map(of).collect::<Vec<f64>>(), 6);
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"utf-8\"?><modelSet texture=\"3\">\n<material>Velvet &amp; Co</material>\n<AccelUnits>m/s^2</AccelUnits>\n\
         <SpeedUnits>mm/s</SpeedUnits>\n<ForceUnits>N</ForceUnits>\n<SampleRate>1000</SampleRate>\n<mu>0.25</mu>\n<numMod>{}</numMod>\n\
         <numTri>{}</numTri>\n<maxSpeed>242.346758</maxSpeed><maxForce>6.558225</maxForce>\n<speedList>{}</speedList>\n<forceList>{}</forceList>\n\
         {triangles}<numARCoeff>{}</numARCoeff><numMACoeff>{}</numMACoeff>\n",
        models.len(),
        triangles.matches("<tri ").count(),
        lists(|model| model.speed),
        lists(|model| model.force),
        models[0].ar.len() - 1,
        models[0].ma.len() - 1,
    );
    for (i, model) in models.iter().enumerate() {
        text += &format!(
            "<model><modNum>{}</modNum>\n<ARcoeff>{}</ARcoeff>\n<ARlsf>{}</ARlsf>\n<MAcoeff>{}</MAcoeff>\n<MAlsf>{}</MAlsf>\n\
             <var>{}</var><gain>{}</gain><speedMod>{:.6}</speedMod><forceMod>{:.6}</forceMod></model>\n",
            i + 1,
            decimals(&model.ar, 20),
            lines(&model.ar),
            decimals(&model.ma, 20),
            lines(&model.ma),
            model.variance,
            model.gain,
            model.speed,
            model.force,
        );
    }
    text + "</modelSet>\n"
}
