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
} LwcStatus;

// Decodes a stream as it arrives.
typedef struct LwcDecoder LwcDecoder;

// A stream that owns its bytes.
typedef struct LwcEncoded LwcEncoded;

// A mesh that owns its arrays.
typedef struct LwcMesh LwcMesh;

// How to encode. See `EncodeOptions` of the Rust library for what the numbers mean.
typedef struct LwcEncodeOptions {
  // Name of the descriptor, such as "harris3d"; null for the default.
  const char *descriptor;
  // Name of the partition, "balanced" or "algorithm1"; null for the default.
  const char *partition;
  // What the balanced partition aims at, "size", "balanced" or "prefix"; null for the default.
  const char *optimize;
  // Topological radius of the window, in edges.
  uint32_t rings;
  // Euclidean radius of the window, in mean edges.
  double radius;
  // Factor of the radius from each level to the next coarser one.
  double growth;
  // Bits per coordinate, 1 to 30.
  uint32_t quantization;
  // Levels above the base mesh; negative: until the base mesh is small.
  int32_t levels;
  // Grid steps to the mean edge of a level; 0: by the error of each level.
  double steps_per_edge;
} LwcEncodeOptions;

// How to decode, and what a stream that is not trusted may ask for.
typedef struct LwcDecodeOptions {
  // Last level wanted, 0 is the base mesh; negative for all.
  int32_t level;
  // Most bytes of memory the decoder may hold.
  uint64_t max_memory;
  // Most vertices of the finest mesh decoded.
  uint32_t max_vertices;
  // Most levels.
  uint32_t max_levels;
} LwcDecodeOptions;

// A pass, and the mesh that stands after it.
typedef struct LwcPass {
  // 0 base mesh, 1 split: vertices of one level, 2 refine: one more bit of precision.
  uint32_t kind;
  // Level after the pass.
  uint32_t level;
  // Bits per coordinate after the pass.
  uint32_t precision;
  // Vertices after the pass.
  uint32_t vertices;
  // Triangles after the pass.
  uint32_t faces;
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

// Encodes a mesh. `options` may be null for the defaults.
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

// Decodes a stream, or the beginning of one, in one call. `options` may be null for the defaults.
//
// # Safety
// `bytes` has `num_bytes` elements; `options` is null or can be read; `mesh` can be written to.
enum LwcStatus lwc_decode(const uint8_t *bytes,
                          size_t num_bytes,
                          const struct LwcDecodeOptions *options,
                          struct LwcMesh **mesh);

// Makes a decoder. `options` may be null for the defaults. Null if memory is short.
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

// Passes that the stream announces; 0 before its table of passes has come.
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

// Says more about the last call of this thread that failed; valid until the next one that does.
const char *lwc_last_error(void);

// All levels, the limits of the Rust library.
struct LwcDecodeOptions lwc_decode_options_default(void);

// The defaults of the Rust library.
struct LwcEncodeOptions lwc_encode_options_default(void);

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
