"""Tests of the images that boot loaders take."""

import struct
import unittest

from husillo_firmware.image import PAGE, esp_image, flash, uf2


class Images(unittest.TestCase):
    """Files of small programs, read with the rules of their boot loaders."""

    def test_an_esp_image_has_its_parts_and_the_sum_of_their_bytes(self) -> None:
        parts = [(0x4038_4000, b"\x01\x02\x03\x04\x05"), (0x3FC8_0000, b"\xff\x00\x10\x20")]
        for length in range(1, 20):
            image = esp_image(0x4038_4002, [*parts, (0x3FC8_1000, bytes(range(length)))])
            self.assertEqual(image[:4], b"\xe9\x03\x02\x20")
            self.assertEqual(struct.unpack_from("<I", image, 4), (0x4038_4002,))
            # The chip, and no hash behind the checksum.
            self.assertEqual(struct.unpack_from("<H", image, 12), (5,))
            self.assertEqual(image[23], 0)
            place, check = 24, 0xEF
            for address, data in [*parts, (0x3FC8_1000, bytes(range(length)))]:
                at, size = struct.unpack_from("<II", image, place)
                self.assertEqual((at, size), (address, -(-len(data) // 4) * 4))
                place += 8
                self.assertEqual(image[place : place + len(data)], data)
                for byte in image[place : place + size]:
                    check ^= byte
                place += size
            self.assertEqual(len(image) % 16, 0)
            self.assertTrue(1 <= len(image) - place <= 16)
            self.assertEqual(image[-1], check)

    def test_the_other_files_have_every_page(self) -> None:
        pages = {0x1000_0000: bytearray(PAGE), 0x1000_0200: bytearray(b"\x55" * PAGE)}
        blocks = list(uf2(pages, 7))
        self.assertEqual([len(block) for block in blocks], [512, 512])
        self.assertEqual(struct.unpack_from("<I", blocks[1], 12), (0x1000_0200,))
        self.assertEqual(b"".join(flash(pages)), bytes(PAGE) + b"\xff" * PAGE + b"\x55" * PAGE)


if __name__ == "__main__":
    unittest.main()
