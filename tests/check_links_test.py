#!/usr/bin/env python3
"""check_links.py must itself be able to fail: each kind of link dangles once in a tree of its own."""

import os
import tempfile
import unittest

import check_links


class Links(unittest.TestCase):
    def setUp(self):
        self.tree = tempfile.TemporaryDirectory()
        self.addCleanup(self.tree.cleanup)
        self.write("README.md", "# Top\n")
        self.write("docs/other.md", "# Other\n\n## LCM & CAN: `bus`\n\n## Twice\n\n## Twice\n")
        self.write("docs/picture.png", "")

    def write(self, path, text):
        full = os.path.join(self.tree.name, path)
        os.makedirs(os.path.dirname(full), exist_ok=True)
        with open(full, "w", encoding="utf-8") as document:
            document.write(text)

    def found(self, text, path="docs/page.md"):
        self.write(path, text)
        return list(check_links.violations(self.tree.name))

    def assert_dangling(self, text, words, line=1):
        found = self.found(text)
        self.assertEqual(len(found), 1, found)
        self.assertTrue(found[0].startswith(f"docs/page.md:{line}: "), found[0])
        self.assertIn(words, found[0])

    def test_good_links_pass(self):
        self.assertEqual(self.found("[a](other.md) ![p](picture.png) [top](../README.md#top) [up](..) [w](https://x.y/z)\n"
                                    "[b](other.md#lcm--can-bus) [c](other.md#twice-1) [here](#page) [m](mailto:a@b)\n"
                                    "# Page\n[![x](picture.png)](other.md)\n\n[r]: other.md\n"), [])

    def test_a_file_that_is_not_there(self):
        self.assert_dangling("text\n[a](absent.md)\n", "absent.md leads to nothing", 2)

    def test_a_picture_that_is_not_there(self):
        self.assert_dangling("![a](absent.png)\n", "leads to nothing")

    def test_a_picture_inside_a_link(self):
        self.assert_dangling("[![a](absent.png)](other.md)\n", "absent.png")

    def test_the_second_of_two_on_a_line(self):
        self.assert_dangling("[a](other.md), [b](absent.md)\n", "absent.md")

    def test_a_reference(self):
        self.assert_dangling("[a]: absent.md\n", "leads to nothing")

    def test_a_heading_that_is_not_there(self):
        self.assert_dangling("[a](other.md#lcm)\n", "names no heading")
        self.assert_dangling("[a](#absent)\n", "names no heading")

    def test_out_of_the_tree(self):
        self.assert_dangling("[a](../../x.md)\n", "out of the tree")
        self.assert_dangling("[a](/etc/passwd)\n", "out of the tree")

    def test_code_is_no_link(self):
        self.assertEqual(self.found("`[a](absent.md)`\n\n    [b](absent.md)\n\n```\n[c](absent.md)\n```\n"), [])

    def test_lines_after_code_count_on(self):
        self.assert_dangling("```\nx\n```\n[a](absent.md)\n", "absent.md", 4)

    def test_what_a_build_leaves_is_not_looked_at(self):
        self.assertEqual(self.found("[a](absent.md)\n", "build/npm/x.md"), [])

    def test_an_empty_tree_is_an_error_not_a_pass(self):
        with tempfile.TemporaryDirectory() as empty:
            self.assertEqual(check_links.main(["check_links.py", empty]), 1)


if __name__ == "__main__":
    unittest.main()
