//! Reads a model file: nodes, and the triangles between them.

use htex_format::{Triangle, check_triangles};

use super::document::root;
use super::element::Element;
use super::node::Node;
use super::work::Work;
use crate::error::Fault;

/// Largest relative difference at which two numbers count as the same.
const SAME: f64 = 1e-6;

/// A texture of the toolkit.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    /// Name of the material; empty if the file does not name it.
    pub material: String,
    /// Number of the texture in the toolkit.
    pub number: Option<u32>,
    /// Sample rate of the filters, hertz.
    pub rate_hz: f64,
    /// Coefficient of kinetic friction between tool and surface.
    pub friction: Option<f64>,
    pub max_speed_mm_s: Option<f64>,
    pub max_force_n: Option<f64>,
    pub nodes: Vec<Node>,
    /// Triangles between nodes, given as indices of nodes, starting at 0. If this list is empty, a
    /// player computes the triangles itself.
    pub triangles: Vec<Triangle>,
    /// Notes about the file for the user, as sentences.
    pub notes: Vec<String>,
}

/// Reads a model file.
///
/// # Errors
/// When the file is invalid. The error names the line and the element.
pub fn read(bytes: &[u8]) -> Result<Texture, Fault> {
    let root = root(bytes)?;
    if root.name != "modelSet" {
        let words = "a model file of the toolkit begins with the element modelSet";
        return Err(root.fault(words));
    }
    for (name, unit) in [("AccelUnits", "m/s^2"), ("SpeedUnits", "mm/s"), ("ForceUnits", "N")] {
        check_unit(&root, name, unit)?;
    }
    let mut notes = Vec::new();
    let nodes = nodes(&root, &mut notes)?;
    let number = |name: &str| root.one(name)?.map(Element::number).transpose();
    let number_of_set = root.attributes.iter().find(|(name, _)| name == "texture");
    Ok(Texture {
        material: root
            .one("material")?
            .map_or_else(String::new, |material| material.text.trim().to_owned()),
        number: number_of_set.and_then(|(_, number)| number.trim().parse().ok()),
        rate_hz: root.required("SampleRate")?.number_in(100.0, 1e6)?,
        friction: number("mu")?,
        max_speed_mm_s: number("maxSpeed")?,
        max_force_n: number("maxForce")?,
        triangles: triangles(&root, &nodes, &mut notes)?,
        nodes,
        notes,
    })
}

/// Returns a fault if the file states other units than the toolkit's.
fn check_unit(root: &Element, name: &str, unit: &str) -> Result<(), Fault> {
    match root.one(name)? {
        Some(given) if given.text.trim() != unit => {
            Err(given.fault(format!("{} is not {unit}, the unit of the toolkit", given.quoted())))
        }
        _ => Ok(()),
    }
}

fn nodes(root: &Element, notes: &mut Vec<String>) -> Result<Vec<Node>, Fault> {
    let models: Vec<&Element> = root.all("model").collect();
    check_count(root, "numMod", "model", models.len())?;
    if models.is_empty() {
        return Err(root.fault("it has no element model"));
    }
    // One limit applies to all nodes together, because a file with many small filters takes as long
    // as one with a large filter.
    let mut work = Work::default();
    let nodes = models
        .iter()
        .map(|model| Node::read(model, notes, &mut work))
        .collect::<Result<Vec<Node>, Fault>>()?;
    for (name, order) in [
        ("numARCoeff", nodes.first().map_or(0, |node| node.ar.len())),
        ("numMACoeff", nodes.first().map_or(0, |node| node.ma.len())),
    ] {
        check_order(root, name, order)?;
    }
    for (i, model) in models.iter().enumerate() {
        if let Some(number) = model.one("modNum")?
            && number.count()? != i + 1
        {
            return Err(
                number.fault(format!("this is model {}; they are in ascending order", i + 1))
            );
        }
    }
    check_list(root, "speedList", &nodes, |node| node.speed_mm_s)?;
    check_list(root, "forceList", &nodes, |node| node.force_n)?;
    check_places(&models, &nodes)?;
    Ok(nodes)
}

/// Checks a count that the file may state.
fn check_count(root: &Element, name: &str, of: &str, count: usize) -> Result<(), Fault> {
    match root.one(name)? {
        Some(stated) if stated.count()? != count => Err(stated.fault(format!(
            "{} are stated and there are {count} elements {of}; the file seems damaged",
            stated.quoted()
        ))),
        _ => Ok(()),
    }
}

/// Checks the order of a filter that the file may state. The toolkit does not count the first
/// coefficient.
fn check_order(root: &Element, name: &str, order: usize) -> Result<(), Fault> {
    match root.one(name)? {
        Some(stated) if ![order, order + 1].contains(&stated.count()?) => {
            Err(stated.fault(format!(
                "{} are stated and the first model has {order} behind the first",
                stated.quoted()
            )))
        }
        _ => Ok(()),
    }
}

/// Checks a list that the file may state against the numbers of the nodes.
fn check_list(
    root: &Element,
    name: &str,
    nodes: &[Node],
    of: fn(&Node) -> f64,
) -> Result<(), Fault> {
    let Some(list) = root.one(name)? else {
        return Ok(());
    };
    let values = list.values()?;
    if values.len() != nodes.len() {
        let words = format!("{} values for {} models", values.len(), nodes.len());
        return Err(list.fault(words));
    }
    for (i, (value, own)) in values.iter().zip(nodes.iter().map(of)).enumerate() {
        if (value - own).abs() > SAME * own.abs().max(1.0) {
            return Err(list.fault(format!("value {} is {value}; the model has {own}", i + 1)));
        }
    }
    Ok(())
}

/// Returns a fault if two nodes have the same speed and force.
fn check_places(models: &[&Element], nodes: &[Node]) -> Result<(), Fault> {
    let mut seen = std::collections::BTreeMap::new();
    for (model, node) in models.iter().zip(nodes) {
        let motion = (node.speed_mm_s.to_bits(), node.force_n.to_bits());
        if let Some(first) = seen.insert(motion, node.line) {
            return Err(model.fault(format!(
                "another model, of line {first}, is at {} mm/s and {} N too",
                node.speed_mm_s, node.force_n
            )));
        }
    }
    Ok(())
}

fn triangles(
    root: &Element,
    nodes: &[Node],
    notes: &mut Vec<String>,
) -> Result<Vec<Triangle>, Fault> {
    let elements: Vec<&Element> = root.all("tri").collect();
    check_count(root, "numTri", "tri", elements.len())?;
    let triangles = elements
        .iter()
        .map(|element| triangle(element, nodes.len()))
        .collect::<Result<Vec<Triangle>, Fault>>()?;
    let places: Vec<[f64; 2]> = nodes.iter().map(|node| [node.speed_mm_s, node.force_n]).collect();
    match check_triangles(&places, &triangles) {
        Ok(()) => Ok(triangles),
        Err(error) => {
            let wrong = error.triangle().and_then(|triangle| elements.get(triangle));
            let place = wrong.map(|wrong| format!("{}: ", wrong.place())).unwrap_or_default();
            notes.push(format!(
                "{place}the triangles are left out, and a player finds its own: {error} (models are counted from 0 here)"
            ));
            Ok(Vec::new())
        }
    }
}

/// Reads the corners of a triangle. The file counts nodes from 1.
fn triangle(element: &Element, nodes: usize) -> Result<Triangle, Fault> {
    let corners: Vec<&Element> = element.all("value").collect();
    let corner = |corner: &Element| match corner.count()? {
        number if (1..=nodes).contains(&number) => Ok(number - 1),
        number => Err(corner.fault(format!("there is no model {number}; they are 1 to {nodes}"))),
    };
    match corners[..] {
        [a, b, c] => Ok([corner(a)?, corner(b)?, corner(c)?]),
        _ => Err(element.fault(format!("{} corners; a triangle has three", corners.len()))),
    }
}
