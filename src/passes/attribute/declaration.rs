//! What a stream says about its attributes before it has any values (`format/SPEC.md`, section 4.5).

use super::octahedron::Octahedron;
use crate::mesh::{ComponentType, Domain, MAX_COMPONENTS, Semantic, Values};
use crate::util::budget::Budget;
use crate::util::bytes::Reader;
#[cfg(any(feature = "encoder", test))]
use crate::util::bytes::write_varint;
use std::sync::Arc;

/// Most attributes of a stream.
pub(crate) const MAX_ATTRIBUTES: usize = 64;
/// Values that one byte of payload may add: encoders pad, so that a small stream cannot ask for much memory.
pub(crate) const MAX_VALUES_PER_BYTE: u64 = 1024;
/// Most bits of a channel.
pub(crate) const MAX_BITS: u32 = 30;
/// Most entries of a table.
pub(crate) const MAX_TABLE: usize = 1 << 16;

/// How the entries of an attribute become integers.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Coding {
    /// Component k is `minimum[k] + q · step`, q of `bits` bits.
    Uniform { bits: u32, minimum: Vec<f64>, step: f64 },
    /// A direction as a place on the octahedron.
    Octahedral { bits: u32 },
    /// The number of an entry of this table: names, or numbers that only tell things apart.
    Table { entries: Values },
}

/// One attribute.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Declaration {
    pub(crate) name: String,
    pub(crate) semantic: Semantic,
    pub(crate) domain: Domain,
    pub(crate) num_components: usize,
    pub(crate) is_normalized: bool,
    /// `None`: names.
    pub(crate) scalar: Option<ComponentType>,
    /// Whether there are elements without value.
    pub(crate) has_missing: bool,
    pub(crate) coding: Coding,
}

/// All attributes of a stream, and how many bytes of values follow each pass.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Declarations {
    pub(crate) list: Vec<Declaration>,
    pub(crate) material_libraries: Arc<[String]>,
    /// Per pass; 0 after refinements, which add no elements.
    pub(crate) bytes: Vec<u32>,
}

const NAMES: u8 = 8;
const NORMALIZED: u8 = 1;
const HAS_MISSING: u8 = 2;

impl Declaration {
    /// Integers of an entry.
    pub(crate) fn num_channels(&self) -> usize {
        match self.coding {
            Coding::Uniform { .. } => self.num_components,
            Coding::Octahedral { .. } => 2,
            Coding::Table { .. } => 1,
        }
    }

    /// Entries of the table; 0 without one.
    pub(crate) fn table_len(&self) -> usize {
        if let Coding::Table { entries } = &self.coding { entries.len() / self.num_components } else { 0 }
    }

    /// The range of each channel: from and to, both included.
    pub(crate) fn channel_range(&self) -> [i32; 2] {
        match self.coding {
            Coding::Uniform { bits, .. } => [0, ((1_u32 << bits) - 1) as i32],
            Coding::Octahedral { bits } => {
                let radius = Octahedron::new(bits).radius();
                [-radius, radius]
            }
            Coding::Table { .. } => [0, self.table_len() as i32 - 1],
        }
    }

    /// Appends what the channels of an entry stand for to values of the attribute's type.
    pub(crate) fn restore(&self, channels: &[i32], values: &mut Values) {
        let push = |values: &mut Values, x: f64| {
            if let Some(scalar) = self.scalar {
                values.push_bits(bits_of(scalar, x));
            }
        };
        match &self.coding {
            Coding::Uniform { minimum, step, .. } => {
                for (&q, low) in channels.iter().zip(minimum) {
                    push(values, low + f64::from(q) * step);
                }
            }
            Coding::Octahedral { bits } => {
                let one = self.scalar.filter(|s| s.is_integer()).map_or(1.0, ComponentType::one);
                let direction = Octahedron::new(*bits).direction([channels[0], channels[1]]);
                direction.into_iter().for_each(|x| push(values, x * one));
            }
            Coding::Table { entries } => {
                let first = channels[0] as usize * self.num_components;
                match (entries, values) {
                    (Values::Names(names), Values::Names(out)) => out.extend(names.get(first).cloned()),
                    (entries, out) => (first..first + self.num_components)
                        .filter_map(|k| entries.bits(k))
                        .for_each(|bits| out.push_bits(bits)),
                }
            }
        }
    }
}

/// The bits of the number of a type that is closest to `x`: halves go up, ends of the range stay ends.
pub(crate) fn bits_of(scalar: ComponentType, x: f64) -> u64 {
    // A cast from floats saturates.
    let whole = (x + 0.5).floor();
    match scalar {
        ComponentType::I8 => u64::from(whole as i8 as u8),
        ComponentType::U8 => u64::from(whole as u8),
        ComponentType::I16 => u64::from(whole as i16 as u16),
        ComponentType::U16 => u64::from(whole as u16),
        ComponentType::I32 => u64::from(whole as i32 as u32),
        ComponentType::U32 => u64::from(whole as u32),
        ComponentType::F32 => u64::from((x as f32).to_bits()),
        ComponentType::F64 => x.to_bits(),
    }
}

impl Declarations {
    /// Reads a payload; `None` if it is malformed or the memory is used up.
    pub(crate) fn read(payload: &[u8], budget: &mut Budget) -> Option<Self> {
        let mut reader = Reader::new(payload);
        let count = reader.varint()? as usize;
        if count > MAX_ATTRIBUTES {
            return None;
        }
        budget.take(count, BYTES_PER_DECLARATION)?;
        let mut list = Vec::with_capacity(count);
        for _ in 0..count {
            list.push(read_declaration(&mut reader, budget)?);
        }
        let count = reader.count(1)?;
        // They are moved once, to where they are shared.
        budget.take(count, size_of::<String>())?;
        let material_libraries = reader.strings(count, budget)?.into();
        let count = reader.count(1)?;
        budget.take(count, size_of::<u32>())?;
        let mut bytes = Vec::with_capacity(count);
        for _ in 0..count {
            bytes.push(reader.varint()?);
        }
        reader.is_empty().then_some(Self { list, material_libraries, bytes })
    }

    #[cfg(any(feature = "encoder", test))]
    pub(crate) fn write(&self) -> Vec<u8> {
        let mut out = Vec::new();
        write_varint(&mut out, self.list.len() as u32);
        self.list.iter().for_each(|declaration| write_declaration(&mut out, declaration));
        write_varint(&mut out, self.material_libraries.len() as u32);
        self.material_libraries.iter().for_each(|name| write_string(&mut out, name));
        write_varint(&mut out, self.bytes.len() as u32);
        self.bytes.iter().for_each(|&bytes| write_varint(&mut out, bytes));
        out
    }
}

/// Memory of a declaration without its strings and tables.
const BYTES_PER_DECLARATION: usize = size_of::<Declaration>() + MAX_COMPONENTS * size_of::<f64>();

fn read_declaration(reader: &mut Reader, budget: &mut Budget) -> Option<Declaration> {
    let name = reader.string(budget)?;
    let semantic = match reader.u8()? {
        0 => Semantic::Generic,
        1 => Semantic::Normal,
        2 => Semantic::TexCoord(reader.varint()?),
        3 => Semantic::Color(reader.varint()?),
        4 => Semantic::Material,
        5 => Semantic::Group,
        6 => Semantic::Object,
        _ => return None,
    };
    let domain = *Domain::ALL.get(usize::from(reader.u8()?))?;
    let flags = reader.u8()?;
    let scalar = match reader.u8()? {
        NAMES => None,
        code => Some(*ComponentType::ALL.get(usize::from(code))?),
    };
    let num_components = reader.varint()? as usize;
    let most = if scalar.is_none() { 1 } else { MAX_COMPONENTS };
    if flags & !(NORMALIZED | HAS_MISSING) != 0 || !(1..=most).contains(&num_components) {
        return None;
    }
    let coding = read_coding(reader, scalar, num_components, budget)?;
    let (is_normalized, has_missing) = (flags & NORMALIZED != 0, flags & HAS_MISSING != 0);
    Some(Declaration { name, semantic, domain, num_components, is_normalized, scalar, has_missing, coding })
}

fn read_coding(
    reader: &mut Reader,
    scalar: Option<ComponentType>,
    num_components: usize,
    budget: &mut Budget,
) -> Option<Coding> {
    let coding = match (reader.u8()?, scalar) {
        (0, Some(_)) => {
            let bits = u32::from(reader.u8()?);
            let minimum = (0..num_components).map(|_| reader.f64()).collect::<Option<Vec<f64>>>()?;
            let step = reader.f64()?;
            let is_finite = minimum.iter().all(|m| m.is_finite()) && step.is_finite();
            ((1..=MAX_BITS).contains(&bits) && is_finite).then_some(Coding::Uniform {
                bits,
                minimum,
                step,
            })?
        }
        (1, Some(_)) if num_components == 3 => {
            let bits = u32::from(reader.u8()?);
            (2..=MAX_BITS).contains(&bits).then_some(Coding::Octahedral { bits })?
        }
        (2, _) => {
            let count = reader.varint()? as usize;
            if !(1..=MAX_TABLE).contains(&count) {
                return None;
            }
            let entries = match scalar {
                None => Values::Names(reader.strings(count, budget)?),
                Some(scalar) => {
                    let mut entries = Values::new(scalar);
                    // The array doubles while it grows.
                    let num_values = (count * num_components).min(reader.len());
                    budget.take(num_values, 3 * scalar.num_bytes())?;
                    for _ in 0..count * num_components {
                        let bytes = reader.take(scalar.num_bytes())?;
                        entries.push_bits(bytes.iter().rev().fold(0, |bits, &b| bits << 8 | u64::from(b)));
                    }
                    entries
                }
            };
            Coding::Table { entries }
        }
        _ => return None,
    };
    Some(coding)
}

#[cfg(any(feature = "encoder", test))]
fn write_string(out: &mut Vec<u8>, text: &str) {
    write_varint(out, text.len() as u32);
    out.extend_from_slice(text.as_bytes());
}

#[cfg(any(feature = "encoder", test))]
fn write_declaration(out: &mut Vec<u8>, declaration: &Declaration) {
    write_string(out, &declaration.name);
    let (code, set) = match declaration.semantic {
        Semantic::Generic => (0, None),
        Semantic::Normal => (1, None),
        Semantic::TexCoord(set) => (2, Some(set)),
        Semantic::Color(set) => (3, Some(set)),
        Semantic::Material => (4, None),
        Semantic::Group => (5, None),
        Semantic::Object => (6, None),
    };
    out.push(code);
    if let Some(set) = set {
        write_varint(out, set);
    }
    out.push(Domain::ALL.iter().position(|&d| d == declaration.domain).unwrap_or(0) as u8);
    let flag = |is_set: bool, flag: u8| if is_set { flag } else { 0 };
    out.push(flag(declaration.is_normalized, NORMALIZED) | flag(declaration.has_missing, HAS_MISSING));
    let place = |scalar| ComponentType::ALL.iter().position(|&s| s == scalar).unwrap_or(0) as u8;
    out.push(declaration.scalar.map_or(NAMES, place));
    write_varint(out, declaration.num_components as u32);
    match &declaration.coding {
        Coding::Uniform { bits, minimum, step } => {
            out.extend([0, *bits as u8]);
            minimum.iter().chain([step]).for_each(|x| out.extend_from_slice(&x.to_le_bytes()));
        }
        Coding::Octahedral { bits } => out.extend([1, *bits as u8]),
        Coding::Table { entries } => {
            out.push(2);
            write_varint(out, declaration.table_len() as u32);
            match (entries, declaration.scalar) {
                (Values::Names(names), _) => names.iter().for_each(|name| write_string(out, name)),
                (entries, Some(scalar)) => {
                    (0..entries.len()).filter_map(|k| entries.bits(k)).for_each(|bits| {
                        out.extend_from_slice(&bits.to_le_bytes()[..scalar.num_bytes()]);
                    })
                }
                (_, None) => {}
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(payload: &[u8]) -> Option<Declarations> {
        Declarations::read(payload, &mut Budget::new(0, u64::MAX))
    }

    fn all_codings() -> Declarations {
        let declaration = |name: &str, semantic, domain, scalar, num_components, coding| Declaration {
            name: name.into(),
            semantic,
            domain,
            num_components,
            is_normalized: num_components == 3,
            scalar,
            has_missing: num_components == 2,
            coding,
        };
        let uniform = Coding::Uniform { bits: 10, minimum: vec![-0.5, 2.0], step: 0.25 };
        let names = Coding::Table { entries: Values::Names(vec!["wood".into(), "ü".into()]) };
        let numbers = Coding::Table { entries: Values::I16(vec![-1, 7, 300, 4]) };
        Declarations {
            list: vec![
                declaration(
                    "vt",
                    Semantic::TexCoord(3),
                    Domain::Corner,
                    Some(ComponentType::F32),
                    2,
                    uniform,
                ),
                declaration(
                    "n",
                    Semantic::Normal,
                    Domain::Vertex,
                    Some(ComponentType::I8),
                    3,
                    Coding::Octahedral { bits: 8 },
                ),
                declaration("usemtl", Semantic::Material, Domain::Triangle, None, 1, names),
                declaration("ids", Semantic::Generic, Domain::Triangle, Some(ComponentType::I16), 2, numbers),
            ],
            material_libraries: Arc::new(["a.mtl".to_owned()]),
            bytes: vec![7, 0, 300],
        }
    }

    #[test]
    fn declarations_return_and_cut_ones_are_refused() {
        let declared = all_codings();
        let payload = declared.write();
        assert_eq!(read(&payload), Some(declared));
        for cut in 0..payload.len() {
            assert_eq!(read(&payload[..cut]), None, "{cut} bytes");
        }
    }

    #[test]
    fn no_change_of_a_byte_is_fatal() {
        let payload = all_codings().write();
        let mut refused = 0;
        for at in 0..payload.len() {
            for bit in 0..8 {
                let mut bad = payload.clone();
                bad[at] ^= 1 << bit;
                refused += usize::from(read(&bad).is_none());
            }
        }
        assert!(refused > payload.len() / 2, "{refused}");
    }

    #[test]
    fn entries_return_in_their_type() {
        let declared = all_codings();
        let restore = |k: usize, channels: &[i32]| {
            let mut values = declared.list[k].scalar.map_or(Values::Names(vec![]), Values::new);
            declared.list[k].restore(channels, &mut values);
            values
        };
        assert_eq!(restore(0, &[4, 1023]), Values::F32(vec![0.5, 257.75]));
        assert_eq!(restore(1, &[0, 0]), Values::I8(vec![0, 0, 127]));
        assert_eq!(restore(2, &[1]), Values::Names(vec!["ü".into()]));
        assert_eq!(restore(3, &[1]), Values::I16(vec![300, 4]));
        assert_eq!(bits_of(ComponentType::U8, 300.0), 255);
        assert_eq!(bits_of(ComponentType::I8, -0.5), 0);
    }
}
