/* C interface of lwc. Written by cbindgen from bindings/c/src/lib.rs: do not edit.
 *
 * Objects are made by lwc_*_new, lwc_encode or lwc_decode and freed by the function of the same name that
 * ends in _free. Every pointer that is handed out belongs to its object. No object may be used by two
 * threads at once. Functions that can fail return an LwcStatus; lwc_last_error tells more about the last
 * one that failed in this thread. */

#ifndef LWC_H
#define LWC_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

// Entry of an element that has no value.
#define LWC_NO_ENTRY UINT32_MAX

// How a call ended. The names are those of the errors of the Rust library.
typedef enum LwcStatus {
  // It did what was asked.
  LWC_STATUS_OK = 0,
  // No pass is complete, or there are no more.
  LWC_STATUS_NOTHING_TO_DO = 1,
  // The bytes do not begin a stream.
  LWC_STATUS_NOT_A_STREAM = 2,
  // The stream needs a newer decoder.
  LWC_STATUS_UNSUPPORTED = 3,
  // The stream is damaged.
  LWC_STATUS_CHECKSUM = 4,
  // The bytes follow no syntax that an encoder writes.
  LWC_STATUS_MALFORMED = 5,
  // The mesh is larger than the limits allow.
  LWC_STATUS_LIMIT = 6,
  // The decoder has failed before.
  LWC_STATUS_FAILED = 7,
  // The stream ends before its base mesh is complete.
  LWC_STATUS_NO_MESH = 8,
  // The mesh has no usable triangle.
  LWC_STATUS_NO_TRIANGLES = 9,
  // An option is out of range, or has no such name.
  LWC_STATUS_OPTION = 10,
  // The mesh is too large for the format.
  LWC_STATUS_TOO_LARGE = 11,
  // The bounding box overflows double precision.
  LWC_STATUS_BOUNDING_BOX = 12,
  // A triangle names a vertex that does not exist.
  LWC_STATUS_INDEX_OUT_OF_RANGE = 13,
  // A coordinate is NaN or infinite.
  LWC_STATUS_NOT_FINITE = 14,
  // A pointer that must not be null is.
  LWC_STATUS_NULL_POINTER = 15,
  // A mistake in the library.
  LWC_STATUS_INTERNAL = 16,
  // An attribute does not fit its mesh, or a buffer its attribute.
  LWC_STATUS_ATTRIBUTE = 17,
  // An array cannot be one: its address is not a multiple of its type's alignment, or it has more bytes than memory
  // can.
  LWC_STATUS_ARRAY = 18,
  // The calling thread rounds floating-point numbers another way than to nearest, or takes subnormal ones for zero:
  // its mode must be the default one. Game engines, audio libraries and code built with fast arithmetic change it.
  LWC_STATUS_FLOATING_POINT = 19,
} LwcStatus;

// What the values mean.
typedef enum LwcSemantic {
  // Anything; the name says what.
  LWC_SEMANTIC_GENERIC = 0,
  // Direction away from the surface, three components.
  LWC_SEMANTIC_NORMAL = 1,
  // Place in a texture.
  LWC_SEMANTIC_TEXCOORD = 2,
  // Red, green, blue and perhaps opacity.
  LWC_SEMANTIC_COLOR = 3,
  // Which material.
  LWC_SEMANTIC_MATERIAL = 4,
  // Which group of triangles.
  LWC_SEMANTIC_GROUP = 5,
  // Which object, or part of a scene.
  LWC_SEMANTIC_OBJECT = 6,
} LwcSemantic;

// What has a value.
typedef enum LwcAttributeDomain {
  // Every vertex.
  LWC_ATTRIBUTE_DOMAIN_VERTEX = 0,
  // Every corner: element 3 t + i is corner i of triangle t.
  LWC_ATTRIBUTE_DOMAIN_CORNER = 1,
  // Every triangle.
  LWC_ATTRIBUTE_DOMAIN_TRIANGLE = 2,
} LwcAttributeDomain;

// The type of the values.
typedef enum LwcComponentType {
  LWC_COMPONENT_TYPE_I8 = 0,
  LWC_COMPONENT_TYPE_U8 = 1,
  LWC_COMPONENT_TYPE_I16 = 2,
  LWC_COMPONENT_TYPE_U16 = 3,
  LWC_COMPONENT_TYPE_I32 = 4,
  LWC_COMPONENT_TYPE_U32 = 5,
  LWC_COMPONENT_TYPE_F32 = 6,
  LWC_COMPONENT_TYPE_F64 = 7,
  // Strings, UTF-8, each ends in a zero.
  LWC_COMPONENT_TYPE_NAMES = 8,
} LwcComponentType;

// Where something is lost.
typedef enum LwcLossStage {
  LWC_LOSS_STAGE_READING = 0,
  LWC_LOSS_STAGE_ENCODING = 1,
  LWC_LOSS_STAGE_DECODING = 2,
  LWC_LOSS_STAGE_WRITING = 3,
} LwcLossStage;

// What happens to what is lost.
typedef enum LwcLossKind {
  // Left out: the subject says what.
  LWC_LOSS_KIND_DROPPED = 0,
  // Positions are rounded: a distance in model units.
  LWC_LOSS_KIND_POSITIONS_ROUNDED = 1,
  // Triangles have no area any more.
  LWC_LOSS_KIND_TRIANGLES_COLLAPSED = 2,
  // Triangles face the other way.
  LWC_LOSS_KIND_TRIANGLES_TURNED = 3,
  // Values of an attribute are rounded; of directions the error is an angle in radians.
  LWC_LOSS_KIND_VALUES_ROUNDED = 4,
  // Integers that name things differ.
  LWC_LOSS_KIND_IDENTIFIERS_CHANGED = 5,
  // Values are of another range or colour space.
  LWC_LOSS_KIND_VALUES_CONVERTED = 6,
  // Elements that had no value have one.
  LWC_LOSS_KIND_VALUES_FILLED = 7,
  // Names are written otherwise.
  LWC_LOSS_KIND_NAMES_CHANGED = 8,
  // Polygons are cut into triangles.
  LWC_LOSS_KIND_POLYGONS_TRIANGULATED = 9,
  // Vertices at one place with equal values are one.
  LWC_LOSS_KIND_VERTICES_JOINED = 10,
  // Vertices are repeated.
  LWC_LOSS_KIND_VERTICES_SPLIT = 11,
  // Vertices and triangles come in another order.
  LWC_LOSS_KIND_REORDERED = 12,
  // The mesh is coarser than the finest one.
  LWC_LOSS_KIND_COARSER = 13,
  // Something that this header does not know; the message says what.
  LWC_LOSS_KIND_OTHER = 14,
} LwcLossKind;

// Decodes a stream as it arrives.
typedef struct LwcDecoder LwcDecoder;

// A stream that owns its bytes.
typedef struct LwcEncoded LwcEncoded;

// A mesh with its attributes, that owns its arrays.
typedef struct LwcMesh LwcMesh;

// How to encode. See `EncodeOptions` of the Rust library for what the numbers mean.
typedef struct LwcEncodeOptions {
  // Name of the descriptor, such as "harris3d"; null for the default.
  const char *descriptor;
  // Name of the partition, "weighted-error" or "algorithm1"; null for the default.
  const char *partition;
  // What the partition by weighted error aims at, "size", "balanced" or "prefix"; null for the default.
  const char *optimize;
  // Topological radius of the window, in edges.
  uint32_t rings;
  // Euclidean radius of the window, in mean edges.
  double radius;
  // Factor of the radius from each level to the next coarser one.
  double growth;
  // Bits per coordinate, 1 to 30; not looked at where `step` is set.
  uint32_t quantization_bits;
  // Keep the cubic grid even if more than 1 % of the triangles collapse or turn over in it.
  bool cubic_grid;
  // Steps of a lattice along the axes, model units, above 0; all 0 for the grid of `quantization_bits`.
  double step[3];
  // A point of that lattice, model units. Streams with the same step and origin share borders bit for bit.
  double grid_origin[3];
  // Levels above the base mesh; negative: until the base mesh is small.
  int32_t levels;
  // Grid steps to the mean edge of a level; 0: by the error of each level.
  double steps_per_edge;
  // Bits of each of the two coordinates of a normal, 2 to 30.
  uint32_t normal_bits;
  // Bits of a texture coordinate, 1 to 30.
  uint32_t texcoord_bits;
  // Bits of a component of a colour, 1 to 30.
  uint32_t color_bits;
  // Bits of a component of any other attribute, 1 to 30.
  uint32_t generic_bits;
  // How the passes are coded, "max", "small" or "fast"; null for max where `optimize` is "size", else small.
  const char *profile;
  // Time that may be spent, 0 to 9.
  uint32_t effort;
  // Keep all coordinates bit for bit.
  bool lossless;
  // Keep the order of vertices and triangles and the first corner of each.
  bool keep_order;
  // Keep vertices that no triangle has.
  bool keep_isolated;
  // Keep triangles that name a vertex twice.
  bool keep_degenerate;
} LwcEncodeOptions;

// How to decode, and the limits for an untrusted stream.
typedef struct LwcDecodeOptions {
  // Last level wanted, 0 is the base mesh; negative for all.
  int32_t level;
  // Most bytes of memory the decoder may hold.
  uint64_t max_memory;
  // Most vertices of the finest mesh decoded.
  uint32_t max_vertices;
  // Most levels.
  uint32_t max_levels;
  // Most units of work, each about a tenth of a microsecond; 0: in proportion to the bytes of the stream.
  uint64_t max_work;
  // Leave the vertices of coarse levels where they are in the finest mesh.
  bool no_shrinkage_compensation;
} LwcDecodeOptions;

// A pass, and the mesh after it.
typedef struct LwcPass {
  // 0 base mesh, 1 split: vertices of one level, 2 refine: one more bit of precision.
  uint32_t kind;
  // Level after the pass.
  uint32_t level;
  // Bits per coordinate after the pass.
  uint32_t quantization_bits;
  // Vertices after the pass.
  uint32_t vertices;
  // Triangles after the pass.
  uint32_t triangles;
  // Bytes of its chunk.
  uint64_t bytes;
  // Bytes of the stream up to the end of the pass.
  uint64_t end;
} LwcPass;

// What a pass changed. Indices of vertices and triangles never move.
typedef struct LwcChanges {
  // The pass.
  struct LwcPass pass;
  // Vertices from this one on are new or have moved.
  uint32_t first_vertex;
  // Triangles from this one on are new.
  uint32_t first_new_triangle;
  // Runs of older triangles with other vertices, each a first and an end; valid until the next call.
  const uint32_t (*rewritten)[2];
  // Number of those runs.
  size_t num_rewritten;
} LwcChanges;

// An attribute: a table of values, and which entry of it each element has.
typedef struct LwcAttribute {
  // What the file calls it, UTF-8, ends in a zero.
  const char *name;
  // An LwcSemantic.
  uint32_t semantic;
  // Of texture coordinates and colours, which of several.
  uint32_t set_index;
  // An LwcAttributeDomain.
  uint32_t domain;
  // An LwcComponentType.
  uint32_t component_type;
  // Components of an entry, 1 to 16; 1 for names.
  uint32_t num_components;
  // Whether integers are fractions of the largest of their type.
  bool normalized;
  // Entries of the table.
  size_t num_entries;
} LwcAttribute;

// One thing that is lost.
typedef struct LwcLoss {
  // An LwcLossStage.
  uint32_t stage;
  // An LwcLossKind.
  uint32_t kind;
  // Elements concerned; -1 if they were not counted.
  int64_t count;
  // Of how many; -1 if that is not known.
  int64_t total;
  // The largest error; NaN if there is none.
  double largest_error;
  // Of positions: the largest error of a vertex divided by the mean length of its edges; else NaN.
  double largest_error_in_edges;
  // What, UTF-8: the name of an attribute, or a few words; may be empty. Valid as long as its mesh or stream.
  const char *subject;
  // A sentence, UTF-8. Valid as long as its mesh or stream.
  const char *message;
} LwcLoss;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Makes a mesh of a copy of `positions` (num_vertices × 3, model units) and `triangles` (num_triangles × 3,
// counter-clockwise).
//
// # Safety
// The arrays have that many elements; `mesh` can be written to.
enum LwcStatus lwc_mesh_new(const double *positions,
                            size_t num_vertices,
                            const uint32_t *triangles,
                            size_t num_triangles,
                            struct LwcMesh **mesh);

// Frees a mesh; null is allowed.
//
// # Safety
// `mesh` was handed out by this library and is not used afterwards.
void lwc_mesh_free(struct LwcMesh *mesh);

// Number of vertices; 0 for null.
//
// # Safety
// `mesh` was handed out by this library and has not been freed.
size_t lwc_mesh_num_vertices(const struct LwcMesh *mesh);

// Number of triangles; 0 for null.
//
// # Safety
// `mesh` was handed out by this library and has not been freed.
size_t lwc_mesh_num_triangles(const struct LwcMesh *mesh);

// Positions, vertices × 3, valid until the mesh is freed; null for null.
//
// # Safety
// `mesh` was handed out by this library and has not been freed.
const double *lwc_mesh_positions(const struct LwcMesh *mesh);

// Vertex indices of the triangles, triangles × 3, valid until the mesh is freed; null for null.
//
// # Safety
// `mesh` was handed out by this library and has not been freed.
const uint32_t *lwc_mesh_triangles(const struct LwcMesh *mesh);

// Encodes a mesh with its attributes. `options` may be null for the defaults.
//
// # Safety
// `mesh` was handed out by this library and has not been freed; `options` is null or can be read; `encoded`
// can be written to.
enum LwcStatus lwc_encode(const struct LwcMesh *mesh,
                          const struct LwcEncodeOptions *options,
                          struct LwcEncoded **encoded);

// Frees a stream; null is allowed.
//
// # Safety
// `encoded` was handed out by this library and is not used afterwards.
void lwc_encoded_free(struct LwcEncoded *encoded);

// The bytes of a stream, valid until it is freed; null for null.
//
// # Safety
// `encoded` was handed out by this library and has not been freed.
const uint8_t *lwc_encoded_bytes(const struct LwcEncoded *encoded);

// Number of bytes; 0 for null.
//
// # Safety
// `encoded` was handed out by this library and has not been freed.
size_t lwc_encoded_num_bytes(const struct LwcEncoded *encoded);

// Decodes a stream, or the beginning of one, with its attributes in one call. `options` may be null for the defaults.
//
// # Safety
// `bytes` has `num_bytes` elements; `options` is null or can be read; `mesh` can be written to.
enum LwcStatus lwc_decode(const uint8_t *bytes,
                          size_t num_bytes,
                          const struct LwcDecodeOptions *options,
                          struct LwcMesh **mesh);

// Makes a decoder. `options` may be null for the defaults. Null if that fails: lwc_last_error says why. Where memory is
// short the program ends, as in all functions here.
//
// # Safety
// `options` is null or can be read.
struct LwcDecoder *lwc_decoder_new(const struct LwcDecodeOptions *options);

// Frees a decoder; null is allowed.
//
// # Safety
// `decoder` was handed out by this library and is not used afterwards.
void lwc_decoder_free(struct LwcDecoder *decoder);

// Takes the next bytes of the stream, however they are cut; lwc_decoder_step decodes them.
//
// # Safety
// `decoder` was handed out by this library, has not been freed and is used by this thread alone; `bytes`
// has `num_bytes` elements.
enum LwcStatus lwc_decoder_feed(struct LwcDecoder *decoder,
                                const uint8_t *bytes,
                                size_t num_bytes);

// Applies the next pass if all its bytes are there: LWC_STATUS_OK and `changes`, or
// LWC_STATUS_NOTHING_TO_DO. After an error the mesh of the last pass is still there. `changes` may be null.
//
// # Safety
// `decoder` was handed out by this library, has not been freed and is used by this thread alone; `changes`
// is null or can be written to.
enum LwcStatus lwc_decoder_step(struct LwcDecoder *decoder,
                                struct LwcChanges *changes);

// Vertices of the mesh at hand; 0 before the base mesh.
//
// # Safety
// `decoder` was handed out by this library and has not been freed.
size_t lwc_decoder_num_vertices(const struct LwcDecoder *decoder);

// Triangles of the mesh at hand; 0 before the base mesh.
//
// # Safety
// `decoder` was handed out by this library and has not been freed.
size_t lwc_decoder_num_triangles(const struct LwcDecoder *decoder);

// Positions of the mesh at hand, vertices × 3, model units; valid until the next call with this decoder.
//
// # Safety
// `decoder` was handed out by this library and has not been freed.
const double *lwc_decoder_positions(const struct LwcDecoder *decoder);

// Vertex indices of the mesh at hand, triangles × 3; valid until the next call with this decoder.
//
// # Safety
// `decoder` was handed out by this library and has not been freed.
const uint32_t *lwc_decoder_triangles(const struct LwcDecoder *decoder);

// Checksum of the mesh at hand: equal on every platform (`format/SPEC.md`, section 9); 0 without a mesh.
//
// # Safety
// `decoder` was handed out by this library and has not been freed.
uint32_t lwc_decoder_checksum(const struct LwcDecoder *decoder);

// A copy of the mesh at hand as it was encoded: vertices stitched where the surface was cut; after the last pass also
// isolated vertices, degenerate faces, exact positions and the order of the file, if the stream has them; with the
// attributes. It is to be freed by lwc_mesh_free. LWC_STATUS_NO_MESH before the base mesh.
//
// # Safety
// `decoder` was handed out by this library and has not been freed; `mesh` can be written to.
enum LwcStatus lwc_decoder_mesh(const struct LwcDecoder *decoder,
                                struct LwcMesh **mesh);

// Checksum of the values of all attributes so far (`format/SPEC.md`, section 9); 0 without any.
//
// # Safety
// `decoder` was handed out by this library and has not been freed.
uint32_t lwc_decoder_attribute_checksum(const struct LwcDecoder *decoder);

// Number of passes of the stream; 0 before its table of passes has arrived.
//
// # Safety
// `decoder` was handed out by this library and has not been freed.
size_t lwc_decoder_num_passes(const struct LwcDecoder *decoder);

// What the stream says of one of its passes.
//
// # Safety
// `decoder` was handed out by this library and has not been freed; `found` can be written to.
enum LwcStatus lwc_decoder_pass(const struct LwcDecoder *decoder,
                                size_t index,
                                struct LwcPass *found);

// True once the last pass of the stream, or of the wanted level, has been applied.
//
// # Safety
// `decoder` was handed out by this library and has not been freed.
bool lwc_decoder_is_complete(const struct LwcDecoder *decoder);

// Gives a mesh an attribute: a copy of `values`, num_entries × components of the type of `what` (for names pointers to
// strings), and of `entries`, for each element the entry it has or LWC_NO_ENTRY. `entries` may be null: element k has entry k.
// There are as many elements as the mesh has vertices, corners (3 × triangles) or triangles.
//
// # Safety
// `mesh` was handed out by this library, has not been freed and is used by this thread alone; `what` can be read and
// its name ends in a zero; `values` and `entries` have that many elements and are aligned for their type.
enum LwcStatus lwc_mesh_add_attribute(struct LwcMesh *mesh,
                                      const struct LwcAttribute *what,
                                      const void *values,
                                      const uint32_t *entries);

// Number of attributes; 0 for null.
//
// # Safety
// `mesh` was handed out by this library and has not been freed.
size_t lwc_mesh_num_attributes(const struct LwcMesh *mesh);

// Index of the first attribute of this name; LWC_STATUS_NOTHING_TO_DO if there is none.
//
// # Safety
// `mesh` was handed out by this library and has not been freed; `name` ends in a zero; `index` can be written to.
enum LwcStatus lwc_mesh_find_attribute(const struct LwcMesh *mesh,
                                       const char *name,
                                       size_t *index);

// What an attribute is; its name is valid until the mesh is freed or gets another attribute.
//
// # Safety
// `mesh` was handed out by this library and has not been freed; `found` can be written to.
enum LwcStatus lwc_mesh_attribute(const struct LwcMesh *mesh,
                                  size_t index,
                                  struct LwcAttribute *found);

// Copies the table of an attribute, num_entries × components numbers of its type, into a buffer of exactly that size in
// bytes. Not for names.
//
// # Safety
// `mesh` was handed out by this library and has not been freed; `values` has `num_bytes` bytes.
enum LwcStatus lwc_mesh_attribute_values(const struct LwcMesh *mesh,
                                         size_t index,
                                         void *values,
                                         size_t num_bytes);

// Copies the entry of each element, or LWC_NO_ENTRY, into an array of exactly as many elements as the mesh has of the
// attribute's domain.
//
// # Safety
// `mesh` was handed out by this library and has not been freed; `entries` has `num_elements` elements.
enum LwcStatus lwc_mesh_attribute_indices(const struct LwcMesh *mesh,
                                          size_t index,
                                          uint32_t *entries,
                                          size_t num_elements);

// The name in an entry of an attribute of names, valid until the mesh is freed or gets another attribute; null if there
// is none.
//
// # Safety
// `mesh` was handed out by this library and has not been freed.
const char *lwc_mesh_attribute_name(const struct LwcMesh *mesh,
                                    size_t index,
                                    size_t entry);

// How many texts a mesh has besides its attributes, such as its coordinate reference system.
//
// # Safety
// `mesh` is null, or was handed out by this library and has not been freed.
size_t lwc_mesh_num_metadata(const struct LwcMesh *mesh);

// One of these texts and its key (`crs.wkt`), valid until the mesh is freed; LWC_STATUS_NOTHING_TO_DO if there is none.
//
// # Safety
// `mesh` was handed out by this library and has not been freed; `key` and `text` can be written to.
enum LwcStatus lwc_mesh_metadata(const struct LwcMesh *mesh,
                                 size_t index,
                                 const char **key,
                                 const char **text);

// Says more about the last call of this thread that failed; valid until the next one that does.
const char *lwc_last_error(void);

// Number of things that a stream does not give back of its mesh; 0 for null.
//
// # Safety
// `encoded` was handed out by this library and has not been freed.
size_t lwc_encoded_num_losses(const struct LwcEncoded *encoded);

// Loss `index` of a stream, counted from 0.
//
// # Safety
// `encoded` was handed out by this library and has not been freed; `loss` can be written to.
enum LwcStatus lwc_encoded_loss(const struct LwcEncoded *encoded,
                                size_t index,
                                struct LwcLoss *loss);

// Number of things that a decoded mesh lacks of its stream; 0 for null, and for a mesh that was not decoded.
//
// # Safety
// `mesh` was handed out by this library and has not been freed.
size_t lwc_mesh_num_losses(const struct LwcMesh *mesh);

// Loss `index` of a decoded mesh, counted from 0.
//
// # Safety
// `mesh` was handed out by this library and has not been freed; `loss` can be written to.
enum LwcStatus lwc_mesh_loss(const struct LwcMesh *mesh, size_t index, struct LwcLoss *loss);

// All levels, the limits of the Rust library.
struct LwcDecodeOptions lwc_decode_options_default(void);

// The defaults of the Rust library.
struct LwcEncodeOptions lwc_encode_options_default(void);

// Gives a mesh an attribute: a copy of `values`, num_entries × components of the type of `what` (for names pointers to
// strings), and of `entries`, for each element the entry it has or LWC_NO_ENTRY. `entries` may be null: element k has entry k.
// There are as many elements as the mesh has vertices, corners (3 × triangles) or triangles.
//
// # Safety
// `mesh` was handed out by this library, has not been freed and is used by this thread alone; `what` can be read and
// its name ends in a zero; `values` and `entries` have that many elements and are aligned for their type.
enum LwcStatus lwc_mesh_add_attribute(struct LwcMesh *mesh,
                                      const struct LwcAttribute *what,
                                      const void *values,
                                      const uint32_t *entries);

// Number of attributes; 0 for null.
//
// # Safety
// `mesh` was handed out by this library and has not been freed.
size_t lwc_mesh_num_attributes(const struct LwcMesh *mesh);

// Index of the first attribute of this name; LWC_STATUS_NOTHING_TO_DO if there is none.
//
// # Safety
// `mesh` was handed out by this library and has not been freed; `name` ends in a zero; `index` can be written to.
enum LwcStatus lwc_mesh_find_attribute(const struct LwcMesh *mesh,
                                       const char *name,
                                       size_t *index);

// What an attribute is; its name is valid until the mesh is freed or gets another attribute.
//
// # Safety
// `mesh` was handed out by this library and has not been freed; `found` can be written to.
enum LwcStatus lwc_mesh_attribute(const struct LwcMesh *mesh,
                                  size_t index,
                                  struct LwcAttribute *found);

// Copies the table of an attribute, num_entries × components numbers of its type, into a buffer of exactly that size in
// bytes. Not for names.
//
// # Safety
// `mesh` was handed out by this library and has not been freed; `values` has `num_bytes` bytes.
enum LwcStatus lwc_mesh_attribute_values(const struct LwcMesh *mesh,
                                         size_t index,
                                         void *values,
                                         size_t num_bytes);

// Copies the entry of each element, or LWC_NO_ENTRY, into an array of exactly as many elements as the mesh has of the
// attribute's domain.
//
// # Safety
// `mesh` was handed out by this library and has not been freed; `entries` has `num_elements` elements.
enum LwcStatus lwc_mesh_attribute_indices(const struct LwcMesh *mesh,
                                          size_t index,
                                          uint32_t *entries,
                                          size_t num_elements);

// The name in an entry of an attribute of names, valid until the mesh is freed or gets another attribute; null if there
// is none.
//
// # Safety
// `mesh` was handed out by this library and has not been freed.
const char *lwc_mesh_attribute_name(const struct LwcMesh *mesh,
                                    size_t index,
                                    size_t entry);

// How many texts a mesh has besides its attributes, such as its coordinate reference system.
//
// # Safety
// `mesh` is null, or was handed out by this library and has not been freed.
size_t lwc_mesh_num_metadata(const struct LwcMesh *mesh);

// One of these texts and its key (`crs.wkt`), valid until the mesh is freed; LWC_STATUS_NOTHING_TO_DO if there is none.
//
// # Safety
// `mesh` was handed out by this library and has not been freed; `key` and `text` can be written to.
enum LwcStatus lwc_mesh_metadata(const struct LwcMesh *mesh,
                                 size_t index,
                                 const char **key,
                                 const char **text);

// Says more about the last call of this thread that failed; valid until the next one that does.
const char *lwc_last_error(void);

// All levels, the limits of the Rust library.
struct LwcDecodeOptions lwc_decode_options_default(void);

// The defaults of the Rust library.
struct LwcEncodeOptions lwc_encode_options_default(void);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* LWC_H */
