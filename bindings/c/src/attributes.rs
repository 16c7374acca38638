//! What a mesh carries besides positions and triangles. Tables and entries are copied in and out; texts belong to the mesh.

use crate::error::{Status, guard, tell};
use crate::{Mesh, check_array, elements, object, put};
use lwc::mesh::{self, Attributes, Domain, NO_ENTRY, Values};
use std::ffi::{CStr, CString, c_char, c_void};

/// What the values mean.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Semantic {
    /// Anything; the name says what.
    Generic = 0,
    /// Direction away from the surface, three components.
    Normal = 1,
    /// Place in a texture.
    Texcoord = 2,
    /// Red, green, blue and perhaps opacity.
    Color = 3,
    /// Which material.
    Material = 4,
    /// Which group of triangles.
    Group = 5,
    /// Which object, or part of a scene.
    Object = 6,
}

/// What has a value.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AttributeDomain {
    /// Every vertex.
    Vertex = 0,
    /// Every corner: element 3 t + i is corner i of triangle t.
    Corner = 1,
    /// Every triangle.
    Triangle = 2,
}

/// The type of the values.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)] // Each is what its name says.
pub enum ComponentType {
    I8 = 0,
    U8 = 1,
    I16 = 2,
    U16 = 3,
    I32 = 4,
    U32 = 5,
    F32 = 6,
    F64 = 7,
    /// Strings, UTF-8, each ends in a zero.
    Names = 8,
}

/// Entry of an element that has no value.
pub const LWC_NO_ENTRY: u32 = u32::MAX;

// The header wants the number itself.
const _: () = assert!(LWC_NO_ENTRY == NO_ENTRY);

/// An attribute: a table of values, and which entry of it each element has.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Attribute {
    /// What the file calls it, UTF-8, ends in a zero.
    pub name: *const c_char,
    /// An LwcSemantic.
    pub semantic: u32,
    /// Of texture coordinates and colours, which of several.
    pub set_index: u32,
    /// An LwcAttributeDomain.
    pub domain: u32,
    /// An LwcComponentType.
    pub component_type: u32,
    /// Components of an entry, 1 to 16; 1 for names.
    pub num_components: u32,
    /// Whether integers are fractions of the largest of their type.
    pub normalized: bool,
    /// Entries of the table.
    pub num_entries: usize,
}

/// Texts as C wants them, of one attribute.
pub struct Texts {
    name: CString,
    names: Vec<CString>,
}

impl Texts {
    pub fn of(attributes: &Attributes) -> Vec<Self> {
        attributes.list.iter().map(Self::new).collect()
    }

    fn new(attribute: &mesh::Attribute) -> Self {
        let names = attribute.values.names().unwrap_or_default();
        Self { name: text(&attribute.name), names: names.iter().map(|name| text(name)).collect() }
    }
}

/// A text up to its first zero, which ends it for C.
fn text(text: &str) -> CString {
    CString::new(text.split('\0').next().unwrap_or_default()).unwrap_or_default()
}

/// Keys and texts as C wants them.
pub fn metadata_of(attributes: &Attributes) -> Vec<[CString; 2]> {
    attributes.metadata.iter().map(|(key, value)| [text(key), text(value)]).collect()
}

fn misfit(sentence: &str) -> Status {
    tell(Status::Attribute, sentence)
}

fn from_c(semantic: u32, set_index: u32) -> Option<mesh::Semantic> {
    Some(match semantic {
        0 => mesh::Semantic::Generic,
        1 => mesh::Semantic::Normal,
        2 => mesh::Semantic::TexCoord(set_index),
        3 => mesh::Semantic::Color(set_index),
        4 => mesh::Semantic::Material,
        5 => mesh::Semantic::Group,
        6 => mesh::Semantic::Object,
        _ => return None,
    })
}

fn to_c(semantic: mesh::Semantic) -> (Semantic, u32) {
    match semantic {
        mesh::Semantic::Normal => (Semantic::Normal, 0),
        mesh::Semantic::TexCoord(set) => (Semantic::Texcoord, set),
        mesh::Semantic::Color(set) => (Semantic::Color, set),
        mesh::Semantic::Material => (Semantic::Material, 0),
        mesh::Semantic::Group => (Semantic::Group, 0),
        mesh::Semantic::Object => (Semantic::Object, 0),
        _ => (Semantic::Generic, 0),
    }
}

/// The text behind a pointer.
///
/// # Safety
/// `pointer` is null, or a string that ends in a zero.
unsafe fn string(pointer: *const c_char) -> Result<String, Status> {
    if pointer.is_null() {
        return Err(Status::NullPointer);
    }
    // SAFETY: by the contract above, and not null.
    Ok(unsafe { CStr::from_ptr(pointer) }.to_string_lossy().into_owned())
}

/// A copy of a table.
///
/// # Safety
/// `values` has `count` elements of the type, strings for names.
unsafe fn table(component_type: u32, values: *const c_void, count: usize) -> Result<Values, Status> {
    /// # Safety
    /// As of `table`.
    unsafe fn copy<T: Clone>(values: *const c_void, count: usize) -> Result<Vec<T>, Status> {
        // SAFETY: by the contract above.
        Ok(unsafe { elements::<T>(values.cast(), count) }?.to_vec())
    }
    // SAFETY: by the contract above.
    unsafe {
        Ok(match component_type {
            0 => Values::I8(copy(values, count)?),
            1 => Values::U8(copy(values, count)?),
            2 => Values::I16(copy(values, count)?),
            3 => Values::U16(copy(values, count)?),
            4 => Values::I32(copy(values, count)?),
            5 => Values::U32(copy(values, count)?),
            6 => Values::F32(copy(values, count)?),
            7 => Values::F64(copy(values, count)?),
            8 => {
                let names: Vec<*const c_char> = copy(values, count)?;
                Values::Names(names.into_iter().map(|name| string(name)).collect::<Result<_, _>>()?)
            }
            _ => return Err(misfit("there is no such type of values")),
        })
    }
}

/// Gives a mesh an attribute: a copy of `values`, num_entries × components of the type of `what` (for names pointers to
/// strings), and of `entries`, for each element the entry it has or LWC_NO_ENTRY. `entries` may be null: element k has entry k.
/// There are as many elements as the mesh has vertices, corners (3 × triangles) or triangles.
///
/// # Safety
/// `mesh` was handed out by this library, has not been freed and is used by this thread alone; `what` can be read and
/// its name ends in a zero; `values` and `entries` have that many elements and are aligned for their type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_mesh_add_attribute(
    mesh: *mut Mesh,
    what: *const Attribute,
    values: *const c_void,
    entries: *const u32,
) -> Status {
    guard(|| {
        // SAFETY: the caller's promise.
        let (mesh, what) = unsafe { (object(mesh)?, what.as_ref().ok_or(Status::NullPointer)?) };
        let domain =
            Domain::ALL.get(what.domain as usize).ok_or_else(|| misfit("there is no such domain"))?;
        let semantic =
            from_c(what.semantic, what.set_index).ok_or_else(|| misfit("there is no such semantic"))?;
        let count = what.num_entries.checked_mul(what.num_components as usize);
        let count = count.ok_or_else(|| misfit("the table is too large"))?;
        // SAFETY: the caller's promise.
        let (name, values) = unsafe { (string(what.name)?, table(what.component_type, values, count)?) };
        let num_elements = domain.num_elements(&mesh.mesh);
        // SAFETY: the caller's promise.
        let entries =
            (!entries.is_null()).then(|| unsafe { elements(entries, num_elements) }.map(<[u32]>::to_vec));
        let attribute = mesh::Attribute {
            is_normalized: what.normalized,
            indices: entries.transpose()?,
            ..mesh::Attribute::new(name, semantic, *domain, what.num_components as usize, values)
        };
        attribute.validate(&mesh.mesh).map_err(|error| misfit(&error.to_string()))?;
        mesh.texts.push(Texts::new(&attribute));
        mesh.attributes.list.push(attribute);
        Ok(())
    })
}

/// Number of attributes; 0 for null.
///
/// # Safety
/// `mesh` was handed out by this library and has not been freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_mesh_num_attributes(mesh: *const Mesh) -> usize {
    // SAFETY: the caller's promise.
    unsafe { mesh.as_ref() }.map_or(0, |mesh| mesh.attributes.list.len())
}

/// An attribute of a mesh, with the texts that go with it.
///
/// # Safety
/// `mesh` is null, or was handed out by this library and has not been freed.
unsafe fn attribute<'a>(
    mesh: *const Mesh,
    index: usize,
) -> Result<(&'a Mesh, &'a mesh::Attribute, &'a Texts), Status> {
    // SAFETY: by the contract above.
    let mesh = unsafe { mesh.as_ref() }.ok_or(Status::NullPointer)?;
    let found = mesh.attributes.list.get(index).zip(mesh.texts.get(index));
    found.map(|(attribute, texts)| (mesh, attribute, texts)).ok_or(Status::NothingToDo)
}

/// Index of the first attribute of this name; LWC_STATUS_NOTHING_TO_DO if there is none.
///
/// # Safety
/// `mesh` was handed out by this library and has not been freed; `name` ends in a zero; `index` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_mesh_find_attribute(
    mesh: *const Mesh,
    name: *const c_char,
    index: *mut usize,
) -> Status {
    guard(|| {
        // SAFETY: the caller's promise.
        let (mesh, name) = unsafe { (mesh.as_ref().ok_or(Status::NullPointer)?, string(name)?) };
        let place = mesh.attributes.list.iter().position(|attribute| attribute.name == name);
        // SAFETY: the caller's promise.
        unsafe { put(index, place.ok_or(Status::NothingToDo)?) }
    })
}

/// What an attribute is; its name is valid until the mesh is freed or gets another attribute.
///
/// # Safety
/// `mesh` was handed out by this library and has not been freed; `found` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_mesh_attribute(
    mesh: *const Mesh,
    index: usize,
    found: *mut Attribute,
) -> Status {
    guard(|| {
        // SAFETY: the caller's promise.
        let (_, attribute, texts) = unsafe { attribute(mesh, index) }?;
        let (semantic, set_index) = to_c(attribute.semantic);
        let place = |found| mesh::ComponentType::ALL.iter().position(|&other| other == found);
        let component_type =
            attribute.values.component_type().and_then(place).unwrap_or(ComponentType::Names as usize);
        let domain = Domain::ALL.iter().position(|&domain| domain == attribute.domain).unwrap_or(0);
        let what = Attribute {
            name: texts.name.as_ptr(),
            semantic: semantic as u32,
            set_index,
            domain: domain as u32,
            component_type: component_type as u32,
            num_components: attribute.num_components as u32,
            normalized: attribute.is_normalized,
            num_entries: attribute.num_entries(),
        };
        // SAFETY: the caller's promise.
        unsafe { put(found, what) }
    })
}

/// Copies the table of an attribute, num_entries × components numbers of its type, into a buffer of exactly that size in
/// bytes. Not for names.
///
/// # Safety
/// `mesh` was handed out by this library and has not been freed; `values` has `num_bytes` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_mesh_attribute_values(
    mesh: *const Mesh,
    index: usize,
    values: *mut c_void,
    num_bytes: usize,
) -> Status {
    guard(|| {
        // SAFETY: the caller's promise.
        let (_, attribute, _) = unsafe { attribute(mesh, index) }?;
        let component_type = attribute.values.component_type();
        let size = component_type.ok_or_else(|| misfit("names are no numbers"))?.num_bytes();
        let count = attribute.values.len();
        if num_bytes != size * count {
            return Err(misfit(&format!("the table has {} bytes, the buffer {num_bytes}", size * count)));
        }
        let mut bytes: Vec<u8> = Vec::with_capacity(num_bytes);
        for bits in (0..count).filter_map(|k| attribute.values.bits(k)) {
            // The lowest bytes of a word, in the order of this machine.
            let word = bits.to_ne_bytes();
            bytes.extend(if cfg!(target_endian = "little") { &word[..size] } else { &word[8 - size..] });
        }
        // SAFETY: the caller's promise.
        unsafe { copy_out(values.cast(), &bytes) }
    })
}

/// Copies the entry of each element, or LWC_NO_ENTRY, into an array of exactly as many elements as the mesh has of the
/// attribute's domain.
///
/// # Safety
/// `mesh` was handed out by this library and has not been freed; `entries` has `num_elements` elements.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_mesh_attribute_indices(
    mesh: *const Mesh,
    index: usize,
    entries: *mut u32,
    num_elements: usize,
) -> Status {
    guard(|| {
        // SAFETY: the caller's promise.
        let (mesh, attribute, _) = unsafe { attribute(mesh, index) }?;
        let count = attribute.domain.num_elements(&mesh.mesh);
        if num_elements != count {
            return Err(misfit(&format!("there are {count} elements, the array has {num_elements}")));
        }
        let entry = |element| attribute.entry(element).map_or(NO_ENTRY, |entry| entry as u32);
        // SAFETY: the caller's promise.
        unsafe { copy_out(entries, &(0..count).map(entry).collect::<Vec<u32>>()) }
    })
}

/// The name in an entry of an attribute of names, valid until the mesh is freed or gets another attribute; null if there
/// is none.
///
/// # Safety
/// `mesh` was handed out by this library and has not been freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_mesh_attribute_name(
    mesh: *const Mesh,
    index: usize,
    entry: usize,
) -> *const c_char {
    // SAFETY: the caller's promise.
    let found = unsafe { attribute(mesh, index) };
    let name = found.ok().and_then(|(_, _, texts)| texts.names.get(entry));
    name.map_or(std::ptr::null(), |name| name.as_ptr())
}

/// Fills an array of C.
///
/// # Safety
/// `to` is null, or has as many elements as `from`.
unsafe fn copy_out<T: Copy>(to: *mut T, from: &[T]) -> Result<(), Status> {
    if !from.is_empty() {
        check_array(to, from.len())?;
        // SAFETY: by the contract above, neither null nor out of line; what C owns does not overlap with what we made.
        unsafe { std::ptr::copy_nonoverlapping(from.as_ptr(), to, from.len()) };
    }
    Ok(())
}

/// How many texts a mesh has besides its attributes, such as its coordinate reference system.
///
/// # Safety
/// `mesh` is null, or was handed out by this library and has not been freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_mesh_num_metadata(mesh: *const Mesh) -> usize {
    // SAFETY: the caller's promise.
    unsafe { mesh.as_ref() }.map_or(0, |mesh| mesh.metadata.len())
}

/// One of these texts and its key (`crs.wkt`), valid until the mesh is freed; LWC_STATUS_NOTHING_TO_DO if there is none.
///
/// # Safety
/// `mesh` was handed out by this library and has not been freed; `key` and `text` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lwc_mesh_metadata(
    mesh: *const Mesh,
    index: usize,
    key: *mut *const c_char,
    text: *mut *const c_char,
) -> Status {
    guard(|| {
        // SAFETY: the caller's promise.
        let mesh = unsafe { mesh.as_ref() }.ok_or(Status::NullPointer)?;
        let [found_key, found_text] = mesh.metadata.get(index).ok_or(Status::NothingToDo)?;
        // SAFETY: the caller's promise.
        unsafe { put(key, found_key.as_ptr()).and_then(|()| put(text, found_text.as_ptr())) }
    })
}
