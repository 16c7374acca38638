//! Chunks `n` and `m` (`format/SPEC.md`, sections 4.6 and 4.7): the meshes of a scene and their instances;
//! how materials look.

use crate::mesh::{GltfMaterials, IDENTITY, Instance, SceneTable};
use crate::util::budget::Budget;
use crate::util::bytes::Reader;
#[cfg(any(feature = "encoder", test))]
use crate::util::bytes::write_varint;

const UNMOVED: u8 = 0;
const MOVED: u8 = 1;
const SINGLE: u8 = 2;
const DOUBLE: u8 = 3;

/// Memory that a mesh of a scene takes once it is separate: its arrays' heads and a share of its attributes.
const BYTES_PER_MESH: usize = 512;
/// Fewest bytes of an instance: mesh, length of the name, form.
const MIN_INSTANCE: usize = 3;

/// `None` if the payload breaks a rule or the memory is used up.
pub(crate) fn read(payload: &[u8], budget: &mut Budget) -> Option<SceneTable> {
    let mut reader = Reader::new(payload);
    let num_meshes = reader.varint()? as usize;
    let exponents = reader.take(num_meshes)?;
    budget.take(num_meshes, BYTES_PER_MESH)?;
    let exponents: Vec<i8> = exponents.iter().map(|&byte| byte as i8).collect();
    let num_instances = reader.count(MIN_INSTANCE)?;
    budget.take(num_instances, size_of::<Instance>())?;
    let mut instances = Vec::with_capacity(num_instances);
    for _ in 0..num_instances {
        let mesh = reader.varint()? as usize;
        let name = reader.string(budget)?;
        let mut transform = IDENTITY;
        let mut entries = transform.iter_mut().flatten();
        match reader.u8()? {
            UNMOVED => {}
            MOVED => entries.skip(3).step_by(4).try_for_each(|e| single(&mut reader, e))?,
            SINGLE => entries.try_for_each(|e| single(&mut reader, e))?,
            DOUBLE => entries.try_for_each(|e| {
                *e = reader.f64()?;
                Some(())
            })?,
            _ => return None,
        }
        let is_finite = transform.iter().flatten().all(|entry| entry.is_finite());
        if mesh >= num_meshes || !is_finite {
            return None;
        }
        instances.push(Instance { mesh, name, transform });
    }
    reader.is_empty().then_some(SceneTable { exponents, instances })
}

#[cfg(any(feature = "encoder", test))]
pub(crate) fn write(table: &SceneTable) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_varint(&mut bytes, table.exponents.len() as u32);
    bytes.extend(table.exponents.iter().map(|&exponent| exponent as u8));
    write_varint(&mut bytes, table.instances.len() as u32);
    for Instance { mesh, name, transform } in &table.instances {
        write_varint(&mut bytes, *mesh as u32);
        write_varint(&mut bytes, name.len() as u32);
        bytes.extend(name.as_bytes());
        let entries = transform.as_flattened();
        let is_single = entries.iter().all(|&e| f64::from(e as f32).to_bits() == e.to_bits());
        let is_moved = (0..12).all(|k| k % 4 == 3 || entries[k] == IDENTITY.as_flattened()[k]);
        let single = |e: &f64| (*e as f32).to_le_bytes();
        if *transform == IDENTITY {
            bytes.push(UNMOVED);
        } else if is_single && is_moved {
            bytes.push(MOVED);
            bytes.extend(entries.iter().skip(3).step_by(4).flat_map(single));
        } else if is_single {
            bytes.push(SINGLE);
            bytes.extend(entries.iter().flat_map(single));
        } else {
            bytes.push(DOUBLE);
            bytes.extend(entries.iter().flat_map(|e| e.to_le_bytes()));
        }
    }
    bytes
}

fn single(reader: &mut Reader, entry: &mut f64) -> Option<()> {
    *entry = f64::from(reader.f32()?);
    Some(())
}

/// `None` if the payload breaks a rule or the memory is used up.
pub(crate) fn read_materials(payload: &[u8], budget: &mut Budget) -> Option<GltfMaterials> {
    let mut reader = Reader::new(payload);
    let json = reader.string(budget)?;
    let num_images = reader.count(1)?;
    budget.take(num_images, size_of::<Vec<u8>>())?;
    let mut images = Vec::with_capacity(num_images);
    for _ in 0..num_images {
        let length = reader.varint()? as usize;
        let image = reader.take(length)?;
        budget.take(length, 1)?;
        images.push(image.to_vec());
    }
    reader.is_empty().then_some(GltfMaterials { json, images })
}

#[cfg(any(feature = "encoder", test))]
pub(crate) fn write_materials(materials: &GltfMaterials) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_varint(&mut bytes, materials.json.len() as u32);
    bytes.extend(materials.json.as_bytes());
    write_varint(&mut bytes, materials.images.len() as u32);
    for image in &materials.images {
        write_varint(&mut bytes, image.len() as u32);
        bytes.extend(image);
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::{read as read_within, read_materials as read_materials_within, *};

    fn read(payload: &[u8]) -> Option<SceneTable> {
        read_within(payload, &mut Budget::new(0, u64::MAX))
    }

    fn read_materials(payload: &[u8]) -> Option<GltfMaterials> {
        read_materials_within(payload, &mut Budget::new(0, u64::MAX))
    }

    fn table() -> SceneTable {
        let place = |mesh, name: &str, transform| Instance { mesh, name: name.into(), transform };
        let [x, y, z] = IDENTITY;
        let moved = [[1.0, 0.0, 0.0, 2.5], y, z];
        let turned = [[0.0, -1.0, 0.0, 2.5], [1.0, 0.0, 0.0, 0.0], z];
        let exact = [[0.1, 0.0, 0.0, 0.0], y, z];
        let instances = vec![
            place(0, "", [x, y, z]),
            place(2, "tree", moved),
            place(2, "Bäume", turned),
            place(1, "", exact),
        ];
        SceneTable { exponents: vec![0, -3, 127], instances }
    }

    #[test]
    fn scenes_come_back() {
        for table in [table(), SceneTable::default()] {
            assert_eq!(read(&write(&table)), Some(table));
        }
    }

    #[test]
    fn what_is_cut_or_wrong_is_refused() {
        let bytes = write(&table());
        assert!((0..bytes.len()).all(|end| read(&bytes[..end]).is_none()));
        assert_eq!(read(&[&bytes[..], &[0]].concat()), None, "too long");
        assert_eq!(read(&[1, 0, 1, 1, 0, 0]), None, "no such mesh");
        assert_eq!(read(&[1, 0, 1, 0, 0, 4]), None, "no such form");
        assert_eq!(read(&[1, 0, 1, 0, 1, 0xff, 0]), None, "no text");
        let infinite = [&[1, 0, 1, 0, 0, 1][..], &f32::INFINITY.to_le_bytes(), &[0; 8]].concat();
        assert_eq!(read(&infinite), None, "not finite");
    }

    #[test]
    fn materials_come_back_and_cut_ones_are_refused() {
        let json = "{\"materials\":[]}".to_owned();
        let materials = GltfMaterials { json, images: vec![vec![1, 2, 3], Vec::new()] };
        let bytes = write_materials(&materials);
        assert_eq!(read_materials(&bytes), Some(materials));
        assert!((0..bytes.len()).all(|end| read_materials(&bytes[..end]).is_none()));
        assert_eq!(read_materials(&[1, 0xff, 0]), None, "no text");
    }

    #[test]
    fn memory_is_counted_before_it_is_taken() {
        // Three bytes for an instance, one for an image.
        let instances = [&[1, 0, 0xe8, 0x07][..], &[0; 3000]].concat();
        let images = [&[0, 0xe8, 0x07][..], &[0; 1000]].concat();
        for (max_memory, is_enough) in [(200_000, true), (10_000, false)] {
            let mut budget = Budget::new(0, max_memory);
            assert_eq!(read_within(&instances, &mut budget).is_some(), is_enough);
            assert_eq!(budget.exceeded().is_none(), is_enough);
            let mut budget = Budget::new(0, max_memory);
            assert_eq!(read_materials_within(&images, &mut budget).is_some(), is_enough);
            assert_eq!(budget.exceeded().is_none(), is_enough);
        }
        assert_eq!(read(&[0, 0xff, 0xff, 0xff, 0xff, 0x0f]), None, "more than the bytes could hold");
    }
}
