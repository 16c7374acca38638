//! Libraries of materials (MTL) as materials of glTF.
//!
//! MTL does not say what its numbers mean to the eye. Colours are taken as linear, as obj2gltf and most others do.

use crate::{
    io::{
        MeshFile, ReadReport,
        beside::Folder,
        materials::Materials,
        text::{parse_number, quoted, words},
    },
    mesh::Semantic,
};
use serde_json::{Map, Value, json};
use std::collections::{HashMap, HashSet};

/// Bytes of a library, and of all libraries of a model.
const MAX_LIBRARY_BYTES: u64 = 1 << 26;
const MAX_LIBRARIES_BYTES: u64 = 1 << 28;

/// Gives `file` the look of the materials that its faces use.
pub(super) fn attach(file: &mut MeshFile, folder: &mut Folder) {
    if !folder.exists() {
        return;
    }
    let MeshFile { attributes, report, .. } = file;
    let is_material = |semantic: Semantic| semantic == Semantic::Material;
    let names = attributes.list.iter().find(|a| is_material(a.semantic)).and_then(|a| a.values.names());
    let Some(names) = names else { return };
    let mut known = Library::wanting(names);
    let mut num_left = MAX_LIBRARIES_BYTES;
    for statement in &*attributes.material_libraries {
        for (name, text) in read(statement, folder, &mut num_left, report) {
            let folder_of = name.rfind('/').map_or("", |slash| &name[..=slash]);
            if !known.parse(&text, folder_of) {
                let name = quoted(name.as_bytes());
                report.ignore(&format!("materials of {name}, none of which a face has"));
            }
        }
    }
    let mut materials = Materials::default();
    for name in names {
        if let Some(material) = known.materials.get(name) {
            let material = material.to_gltf(name, &mut materials, folder, report);
            materials.push(material);
        }
    }
    attributes.gltf_materials = materials.finish();
}

/// The libraries that a statement names: one with blanks in its name, or several.
fn read(
    statement: &str,
    folder: &mut Folder,
    num_left: &mut u64,
    report: &mut ReadReport,
) -> Vec<(String, Vec<u8>)> {
    let mut read_one = |name: &str| {
        let name = name.replace('\\', "/");
        let most = MAX_LIBRARY_BYTES.min(*num_left);
        let text = folder.read(&name, most + 1)?;
        if text.len() as u64 > most {
            return Err(format!("{} is larger than {most} bytes", quoted(name.as_bytes())));
        }
        *num_left -= text.len() as u64;
        Ok((name, text))
    };
    let whole = read_one(statement);
    let names: Vec<&str> = statement.split_ascii_whitespace().collect();
    let found = match whole {
        Err(_) if names.len() > 1 => names.into_iter().map(&mut read_one).collect(),
        whole => vec![whole],
    };
    let mut note = |message: String| report.ignore(&format!("materials of {message}"));
    found.into_iter().filter_map(|one| one.map_err(&mut note).ok()).collect()
}

/// The materials that are wanted, as far as they are found.
struct Library<'a> {
    wanted: HashSet<&'a str>,
    materials: HashMap<String, Material>,
}

impl<'a> Library<'a> {
    fn wanting(names: &'a [String]) -> Self {
        Self { wanted: names.iter().map(String::as_str).collect(), materials: HashMap::new() }
    }

    /// Adds those of a text that are not known yet; says whether any of it is wanted. `folder`: of the text, with its last
    /// slash.
    fn parse(&mut self, text: &[u8], folder: &str) -> bool {
        let mut is_wanted = false;
        let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
        let mut current: Option<(String, Material)> = None;
        for line in text.split(|&byte| matches!(byte, b'\n' | b'\r')) {
            let line = line.trim_ascii();
            let keyword = words(line).next().unwrap_or_default();
            let rest = line[keyword.len()..].trim_ascii();
            if keyword == b"newmtl" {
                self.materials.extend(current.take());
                let name = decoded(rest);
                is_wanted |= self.wanted.contains(&*name);
                let is_new = self.wanted.contains(&*name) && !self.materials.contains_key(&name);
                current = is_new.then(|| (name, Material::default()));
            } else if let Some((_, material)) = &mut current {
                material.take(keyword, rest, folder);
            }
        }
        self.materials.extend(current);
        is_wanted
    }
}

/// Text that is not UTF-8 is read as Latin-1, as names in OBJ.
fn decoded(text: &[u8]) -> String {
    let latin1 = || text.iter().map(|&byte| char::from(byte)).collect();
    std::str::from_utf8(text).map_or_else(|_| latin1(), str::to_owned)
}

/// What a library says of a material.
#[derive(Default)]
struct Material {
    diffuse: Option<[f64; 3]>,
    specular: Option<[f64; 3]>,
    emissive: Option<[f64; 3]>,
    shininess: Option<f64>,
    opacity: Option<f64>,
    roughness: Option<f64>,
    metallic: Option<f64>,
    diffuse_map: Option<TextureMap>,
    emissive_map: Option<TextureMap>,
    normal_map: Option<TextureMap>,
    bump_map: Option<TextureMap>,
    opacity_map: Option<TextureMap>,
    /// Statements that glTF has no place for, each once.
    others: Vec<String>,
}

/// A texture and how it lies.
#[derive(Clone, Debug, PartialEq)]
struct TextureMap {
    file: String,
    offset: [f64; 2],
    scale: [f64; 2],
    is_clamped: bool,
    bump: f64,
}

/// The longest word that is named as a statement, and how many of a material are.
const MAX_KEYWORD_BYTES: usize = 32;
const MAX_OTHERS: usize = 32;

/// Whether a statement that is read has no number or file where it needs one.
fn is_senseless(keyword: &[u8], rest: &[u8]) -> bool {
    match keyword {
        b"kd" | b"ks" | b"ke" => colour(rest).is_none(),
        b"ns" | b"tr" | b"pr" | b"pm" => words(rest).next().and_then(finite).is_none(),
        b"d" => words(rest).find_map(finite).is_none(),
        b"map_kd" | b"map_ke" | b"norm" | b"map_norm" | b"map_kn" | b"map_bump" | b"bump" | b"map_d" => {
            TextureMap::parse(rest, "").is_none()
        }
        _ => false,
    }
}

impl Material {
    fn take(&mut self, keyword: &[u8], rest: &[u8], folder: &str) {
        let number = || words(rest).next().and_then(finite);
        let map = || TextureMap::parse(rest, folder);
        let keyword = keyword.to_ascii_lowercase();
        if is_senseless(&keyword, rest) {
            self.note("senseless ", &keyword);
        }
        match &*keyword {
            b"kd" => self.diffuse = colour(rest).or(self.diffuse),
            b"ks" => self.specular = colour(rest).or(self.specular),
            b"ke" => self.emissive = colour(rest).or(self.emissive),
            b"ns" => self.shininess = number().or(self.shininess),
            b"d" => self.opacity = words(rest).find_map(finite).or(self.opacity),
            b"tr" => self.opacity = number().map(|tr| 1.0 - tr).or(self.opacity),
            b"pr" => self.roughness = number().or(self.roughness),
            b"pm" => self.metallic = number().or(self.metallic),
            b"map_kd" => self.diffuse_map = map(),
            b"map_ke" => self.emissive_map = map(),
            b"norm" | b"map_norm" | b"map_kn" => self.normal_map = map(),
            b"map_bump" | b"bump" => self.bump_map = map(),
            b"map_d" => self.opacity_map = map(),
            b"" => {}
            _ if keyword[0] == b'#' => {}
            _ => self.note("", &keyword),
        }
    }

    /// Notes a statement that is not kept.
    fn note(&mut self, how: &str, keyword: &[u8]) {
        let is_word = keyword.len() <= MAX_KEYWORD_BYTES && keyword.iter().all(u8::is_ascii_graphic);
        let name = if is_word { how.to_owned() + &decoded(keyword) } else { "other statements".to_owned() };
        if self.others.len() < MAX_OTHERS && !self.others.contains(&name) {
            self.others.push(name);
        }
    }

    fn to_gltf(
        &self,
        name: &str,
        all: &mut Materials,
        folder: &mut Folder,
        report: &mut ReadReport,
    ) -> Value {
        for other in &self.others {
            report.ignore(&format!("{other} of materials"));
        }
        if self.specular.is_some_and(|specular| specular != [0.0; 3]) {
            report.ignore("ks of materials");
        }
        let mut texture =
            |map: &Option<TextureMap>, all: &mut Materials| map.as_ref()?.to_gltf(all, folder, report);
        let mut surface = Map::new();
        let diffuse_map = texture(&self.diffuse_map, all);
        // Some programs write black where only the texture counts.
        let is_shown = |diffuse: &[f64; 3]| *diffuse != [0.0; 3] || diffuse_map.is_none();
        let [r, g, b] = self.diffuse.filter(is_shown).unwrap_or([1.0; 3]).map(unit);
        let alpha = self.opacity.map_or(1.0, unit);
        surface.insert("baseColorFactor".to_owned(), json!([r, g, b, alpha]));
        surface.insert("metallicFactor".to_owned(), self.metallic.map_or(0.0, unit).into());
        surface.insert("roughnessFactor".to_owned(), self.roughness().into());
        insert(&mut surface, "baseColorTexture", diffuse_map);
        let mut material = Map::new();
        material.insert("name".to_owned(), name.into());
        material.insert("pbrMetallicRoughness".to_owned(), surface.into());
        let normal = texture(if self.normal_map.is_some() { &self.normal_map } else { &self.bump_map }, all);
        insert(&mut material, "normalTexture", normal);
        let glow = texture(&self.emissive_map, all);
        self.add_light(&mut material, glow.is_some(), all);
        insert(&mut material, "emissiveTexture", glow);
        let file = |map: &Option<TextureMap>| map.as_ref().map(|map| map.file.clone());
        let is_cut_out = self.opacity_map.is_some() && file(&self.opacity_map) == file(&self.diffuse_map);
        if self.opacity_map.is_some() && !is_cut_out {
            report.ignore("map_d of materials");
        }
        if alpha < 1.0 || is_cut_out {
            material.insert("alphaMode".to_owned(), "BLEND".into());
        }
        material.into()
    }

    /// As wide as the highlight of a Blinn-Phong exponent; what has no highlight is rough.
    fn roughness(&self) -> f64 {
        let has_highlight = self.specular.is_none_or(|specular| specular != [0.0; 3]);
        let from_shininess =
            self.shininess.filter(|_| has_highlight).map(|s| (2.0 / (s.max(0.0) + 2.0)).sqrt());
        self.roughness.map(unit).or(from_shininess).unwrap_or(1.0)
    }

    /// Factors of glTF are at most 1; what is brighter has a strength.
    fn add_light(&self, material: &mut Map<String, Value>, has_map: bool, all: &mut Materials) {
        let black = [0.0; 3];
        let light = self.emissive.filter(|light| *light != black || !has_map);
        let light = light.unwrap_or(if has_map { [1.0; 3] } else { black }).map(|c| c.max(0.0));
        let strength = light.into_iter().fold(1.0, f64::max);
        if light != black {
            material.insert("emissiveFactor".to_owned(), json!(light.map(|c| c / strength)));
        }
        if strength > 1.0 {
            all.uses("KHR_materials_emissive_strength");
            let extension = json!({ "KHR_materials_emissive_strength": { "emissiveStrength": strength } });
            material.insert("extensions".to_owned(), extension);
        }
    }
}

fn insert(object: &mut Map<String, Value>, key: &str, value: Option<Map<String, Value>>) {
    object.extend(value.map(|value| (key.to_owned(), value.into())));
}

fn unit(number: f64) -> f64 {
    number.clamp(0.0, 1.0)
}

fn finite(word: &[u8]) -> Option<f64> {
    parse_number(word).filter(|number| number.is_finite())
}

/// Three numbers, or one for all. Spectra of other files are no colour here.
fn colour(rest: &[u8]) -> Option<[f64; 3]> {
    let numbers: Vec<f64> = words(rest).map_while(finite).take(3).collect();
    match numbers[..] {
        [r, g, b] => Some([r, g, b]),
        [grey] => Some([grey; 3]),
        _ => None,
    }
}

impl TextureMap {
    /// Options, then the name of a file, which may have blanks. `folder`: what the name counts from.
    fn parse(rest: &[u8], folder: &str) -> Option<Self> {
        let mut map =
            Self { file: String::new(), offset: [0.0; 2], scale: [1.0; 2], is_clamped: false, bump: 1.0 };
        let mut rest = rest;
        while let Some(option) = first_word(rest).filter(|word| word.starts_with(b"-")) {
            rest = rest[option.len()..].trim_ascii_start();
            let most = match option {
                b"-o" | b"-s" | b"-t" => 3,
                b"-mm" => 2,
                b"-bm" | b"-boost" | b"-texres" => 1,
                b"-blendu" | b"-blendv" | b"-cc" | b"-clamp" | b"-imfchan" | b"-type" => 0,
                _ => return None,
            };
            if most == 0 {
                let word = first_word(rest)?;
                map.is_clamped |= option == b"-clamp" && word == b"on";
                rest = rest[word.len()..].trim_ascii_start();
                continue;
            }
            let mut numbers = Vec::new();
            while numbers.len() < most
                && let Some(word) = first_word(rest)
                && let Some(number) = finite(word)
            {
                numbers.push(number);
                rest = rest[word.len()..].trim_ascii_start();
            }
            map.set(option, &numbers);
        }
        if rest.is_empty() {
            return None;
        }
        map.file = format!("{folder}{}", decoded(rest).replace('\\', "/"));
        Some(map)
    }

    fn set(&mut self, option: &[u8], numbers: &[f64]) {
        let pair = |usual: [f64; 2]| [0, 1].map(|k| numbers.get(k).copied().unwrap_or(usual[k]));
        match option {
            b"-o" => self.offset = pair(self.offset),
            b"-s" => self.scale = pair(self.scale),
            b"-bm" => self.bump = numbers.first().copied().unwrap_or(1.0),
            _ => {}
        }
    }

    /// A reference to a texture. v counts upwards in OBJ and downwards in glTF.
    fn to_gltf(
        &self,
        all: &mut Materials,
        folder: &mut Folder,
        report: &mut ReadReport,
    ) -> Option<Map<String, Value>> {
        let mut reference = all.texture(&self.file, self.is_clamped, folder, report)?;
        let ([u, v], [su, sv]) = (self.offset, self.scale);
        if (self.offset, self.scale) != ([0.0; 2], [1.0; 2]) {
            all.uses("KHR_texture_transform");
            let transform = json!({ "offset": [u, 1.0 - sv - v], "scale": [su, sv] });
            reference.insert("extensions".to_owned(), json!({ "KHR_texture_transform": transform }));
        }
        if self.bump != 1.0 {
            reference.insert("scale".to_owned(), self.bump.into());
        }
        Some(reference)
    }
}

fn first_word(text: &[u8]) -> Option<&[u8]> {
    words(text).next()
}
