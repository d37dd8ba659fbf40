/**
 * The container of a scene: base64 of a zlib stream of a header and columns of whole numbers.
 * `docs/scene.md` describes the format.
 */

/** The version of the format that this module reads. */
export const VERSION = 1;

/**
 * @typedef {object} Container
 * @property {any} header
 * @property {Map<string, Float64Array>} columns
 */

/**
 * Unpacks a scene.
 *
 * @param {string} text
 * @returns {Promise<Container>}
 * @throws {Error} if the text is no scene, or one of another version
 */
export async function unpack(text) {
    return unpackBytes(await inflate(fromBase64(text.trim())));
}

/**
 * Unpacks a scene that is not compressed, such as one of the simulator as WebAssembly.
 *
 * @param {Uint8Array} bytes
 * @returns {Container}
 * @throws {Error} if the bytes are no scene, or one of another version
 */
export function unpackBytes(bytes) {
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    const end = 4 + view.getUint32(0, true);
    if (end > bytes.length) throw new Error("the header of the scene is cut off");
    const header = JSON.parse(new TextDecoder().decode(bytes.subarray(4, end)));
    if (header.version !== VERSION) {
        throw new Error(
            `the scene has version ${header.version}, this viewer reads ${VERSION}`
        );
    }
    const reader = new Numbers(bytes, end);
    const columns = new Map();
    for (const [name, count] of header.columns) columns.set(name, reader.column(count));
    return { header, columns };
}

/**
 * @param {string} text
 * @returns {Uint8Array}
 */
function fromBase64(text) {
    const binary = atob(text);
    const bytes = new Uint8Array(binary.length);
    for (let index = 0; index < bytes.length; index++) bytes[index] = binary.charCodeAt(index);
    return bytes;
}

/**
 * @param {Uint8Array} bytes
 * @returns {Promise<Uint8Array>}
 */
async function inflate(bytes) {
    const stream = new Blob([/** @type {BlobPart} */ (bytes)]).stream();
    const inflated = stream.pipeThrough(new DecompressionStream("deflate"));
    return new Uint8Array(await new Response(inflated).arrayBuffer());
}

/** Reads columns, one after the other. */
class Numbers {
    /**
     * @param {Uint8Array} bytes
     * @param {number} at
     */
    constructor(bytes, at) {
        this.bytes = bytes;
        this.at = at;
    }

    /**
     * The next column: each number is the sum of the differences up to it. A difference has seven
     * bits per byte, the low ones first. Sums of powers of two are exact up to 2^53.
     *
     * @param {number} count
     */
    column(count) {
        const values = new Float64Array(count);
        const { bytes } = this;
        let { at } = this;
        let sum = 0;
        for (let index = 0; index < count; index++) {
            let byte = bytes[at++];
            const isNegative = byte & 1;
            let value = byte & 0x7f;
            for (let scale = 128; byte > 0x7f; scale *= 128) {
                byte = bytes[at++];
                value += (byte & 0x7f) * scale;
            }
            values[index] = sum += isNegative ? -(value + 1) / 2 : value / 2;
        }
        // Bytes beyond the end are zeros.
        if (at > bytes.length) throw new Error("the columns of the scene are cut off");
        this.at = at;
        return values;
    }
}
