/* Encodes a small mesh, then decodes it in pieces and prints each refinement.
 *
 *   cc refine.c -I ../include -L TARGET/release -l lwc_c -o refine
 */
#include "lwc.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { ALONG = 48, AROUND = 24, VERTICES = ALONG * AROUND, TRIANGLES = 2 * VERTICES };

static void check(LwcStatus status, const char *what) {
    if (status != LWC_STATUS_OK) {
        fprintf(stderr, "%s: %s\n", what, lwc_last_error());
        exit(1);
    }
}

static LwcMesh *torus(void) {
    static double positions[VERTICES][3];
    static uint32_t triangles[TRIANGLES][3];
    for (int i = 0; i < ALONG; i++) {
        for (int j = 0; j < AROUND; j++) {
            double u = i * 6.283185307179586 / ALONG, v = j * 6.283185307179586 / AROUND;
            double *p = positions[i * AROUND + j];
            p[0] = (2 + cos(v)) * cos(u);
            p[1] = (2 + cos(v)) * sin(u);
            p[2] = sin(v);
            uint32_t a = i * AROUND + j, b = i * AROUND + (j + 1) % AROUND;
            uint32_t c = (i + 1) % ALONG * AROUND + j, d = (i + 1) % ALONG * AROUND + (j + 1) % AROUND;
            uint32_t quad[2][3] = {{a, c, d}, {a, d, b}};
            for (int k = 0; k < 6; k++) triangles[2 * a + k / 3][k % 3] = quad[k / 3][k % 3];
        }
    }
    LwcMesh *mesh = NULL;
    check(lwc_mesh_new(positions[0], VERTICES, triangles[0], TRIANGLES, &mesh), "mesh");

    static uint8_t colours[VERTICES][3];
    for (int v = 0; v < VERTICES; v++)
        for (int k = 0; k < 3; k++) colours[v][k] = (uint8_t)(128 + 40 * positions[v][k]);
    LwcAttribute colour = {.name = "colour", .semantic = LWC_SEMANTIC_COLOR, .domain = LWC_ATTRIBUTE_DOMAIN_VERTEX,
                           .component_type = LWC_COMPONENT_TYPE_U8, .num_components = 3, .normalized = true, .num_entries = VERTICES};
    check(lwc_mesh_add_attribute(mesh, &colour, colours, NULL), "colours");
    return mesh;
}

int main(void) {
    LwcMesh *mesh = torus();
    LwcEncodeOptions options = lwc_encode_options_default();
    options.descriptor = "nfv";
    LwcEncoded *encoded = NULL;
    check(lwc_encode(mesh, &options, &encoded), "encode");
    const uint8_t *bytes = lwc_encoded_bytes(encoded);
    size_t size = lwc_encoded_num_bytes(encoded);
    printf("%zu vertices in %zu bytes\n", lwc_mesh_num_vertices(mesh), size);

    LwcDecoder *decoder = lwc_decoder_new(NULL);
    for (size_t at = 0; at < size; at += 100) {
        check(lwc_decoder_feed(decoder, bytes + at, size - at < 100 ? size - at : 100), "feed");
        LwcChanges changes;
        LwcStatus status;
        while ((status = lwc_decoder_step(decoder, &changes)) == LWC_STATUS_OK) {
            printf("level %u at %u bits: %u vertices, %u triangles, from vertex %u on\n", changes.pass.level,
                   changes.pass.quantization_bits, changes.pass.vertices, changes.pass.triangles, changes.first_vertex);
        }
        if (status != LWC_STATUS_NOTHING_TO_DO) check(status, "step");
    }
    printf("complete: %d, checksum %08x\n", lwc_decoder_is_complete(decoder), lwc_decoder_checksum(decoder));
    lwc_decoder_free(decoder);

    LwcDecodeOptions coarse = lwc_decode_options_default();
    coarse.level = 1;
    LwcMesh *first = NULL;
    check(lwc_decode(bytes, size, &coarse, &first), "decode");
    LwcAttribute colour;
    check(lwc_mesh_attribute(first, 0, &colour), "attribute");
    printf("level 1 alone: %zu vertices, %zu rows of %s\n", lwc_mesh_num_vertices(first), colour.num_entries, colour.name);
    lwc_mesh_free(first);

    if (lwc_decode((const uint8_t *)"solid cube", 10, NULL, &first) != LWC_STATUS_NOT_A_STREAM) return 1;
    printf("%s\n", lwc_last_error());
    lwc_encoded_free(encoded);
    lwc_mesh_free(mesh);
    return 0;
}
