#!/usr/bin/env python3
"""check_includes.py must itself be able to fail: each rule is broken once in a tree of its own."""

import os
import tempfile
import unittest

import check_includes


class StructureRules(unittest.TestCase):
    def setUp(self):
        self.tree = tempfile.TemporaryDirectory()
        self.addCleanup(self.tree.cleanup)
        for path in ["core/base/result.h", "core/model/stage_data.h", "core/motion/rigidity.h", "core/pipeline/pipeline.h",
                     "core/evaluation/ate.h", "drivers/camera.h", "services/worker.h", "firmware-host/pelorus/verb.h",
                     "firmware-host/autopilot/pelorus_can.h"]:
            self.write(path, "#pragma once\n")

    def write(self, path, text):
        full = os.path.join(self.tree.name, path)
        os.makedirs(os.path.dirname(full), exist_ok=True)
        with open(full, "w", encoding="utf-8") as source:
            source.write(text)

    def found(self, path, text):
        self.write(path, text)
        return list(check_includes.violations(self.tree.name))

    def assert_refused(self, path, text, words):
        found = self.found(path, text)
        self.assertEqual(len(found), 1, found)
        self.assertIn(words, found[0])
        self.assertTrue(found[0].startswith(path + ":"), found[0])

    def test_a_clean_tree_passes(self):
        self.assertEqual(self.found("core/motion/grouping.cpp",
                                    '#include "core/motion/rigidity.h"\n\n#include <vector>\n#include "core/base/result.h"\n'),
                         [])

    def test_upward_include_inside_core(self):
        self.assert_refused("core/motion/a.cpp", '#include "core/pipeline/pipeline.h"\n', "core/motion may not include")

    def test_evaluation_stays_beside_the_chain(self):
        self.assert_refused("core/evaluation/a.cpp", '#include "core/motion/rigidity.h"\n', "may not include")

    def test_nothing_in_core_includes_evaluation(self):
        self.assert_refused("core/pipeline/a.cpp", '#include "core/evaluation/ate.h"\n', "may not include")

    def test_core_includes_no_driver(self):
        self.assert_refused("core/base/a.cpp", '#include "drivers/camera.h"\n', "may not include")

    def test_drivers_see_base_and_geometry_only(self):
        self.assert_refused("drivers/a.cpp", '#include "core/model/stage_data.h"\n', "drivers may not include")

    def test_services_include_no_program(self):
        self.assert_refused("services/a.cpp", '#include "firmware-host/pelorus/verb.h"\n', "services may not include")

    def test_the_autopilot_receiver_includes_its_neighbors_by_name(self):
        self.assertEqual(self.found("firmware-host/autopilot/a.c", '#include "pelorus_can.h"\n'), [])

    def test_nobody_else_includes_neighbors_by_name(self):
        self.assert_refused("firmware-host/pelorus/a.cpp", '#include "verb.h"\n', "no file of this tree")

    def test_the_autopilot_receiver_stands_alone(self):
        self.assert_refused("firmware-host/autopilot/a.c", '#include "core/base/result.h"\n', "may not include")

    def test_program_includes_everything_below(self):
        self.assertEqual(self.found("firmware-host/pelorus/a.cpp",
                                    '#include "core/pipeline/pipeline.h"\n#include "services/worker.h"\n'), [])

    def test_relative_include(self):
        self.assert_refused("core/motion/a.cpp", '#include "rigidity.h"\n', "no file of this tree")

    def test_own_header_in_angle_brackets(self):
        self.assert_refused("core/motion/a.cpp", "#include <core/base/result.h>\n", "in quotes")

    def test_opencv_in_core(self):
        self.assert_refused("core/frontend/a.cpp", "#include <opencv2/core.hpp>\n", "OpenCV in core")

    def test_opencv_in_drivers_is_allowed(self):
        self.assertEqual(self.found("drivers/a.cpp", "#include <opencv2/core.hpp>\n"), [])

    def test_streams_threads_clocks_prints_and_throws_in_core(self):
        for text, words in [("#include <iostream>\n", "opens no file"), ("#include <thread>\n", "no thread"),
                            ("#include <mutex>\n", "no thread"),
                            ("auto t = std::chrono::steady_clock::now();\n", "no clock"),
                            ('std::printf("%d", 1);\n', "prints nothing"), ("throw 1;\n", "throws nothing")]:
            with self.subTest(text):
                self.assert_refused("core/base/a.cpp", text, words)

    def test_comments_and_strings_may_name_what_code_may_not_use(self):
        self.assertEqual(self.found("core/base/a.cpp", '// printf( and throw\n/* steady_clock\n throw */\nx = "throw";\n'),
                         [])

    def test_exempt_files_may_do_their_one_thing_only(self):
        self.assertEqual(self.found("core/base/stage_timer.cpp", "std::chrono::steady_clock::now();\n"), [])
        self.assert_refused("core/base/stage_timer.cpp", "throw 1;\n", "throws nothing")

    def test_long_file(self):
        self.assert_refused("core/base/a.cpp", "\n" * 301, "301 lines")

    def test_vague_names(self):
        for path in ["core/base/utils.h", "core/common/a.h", "drivers/io_helpers.cpp", "services/misc.txt"]:
            with self.subTest(path):
                self.write(path, "")
                self.assertTrue(any("says nothing" in v for v in check_includes.violations(self.tree.name)), path)
                os.remove(os.path.join(self.tree.name, path))

    def test_unknown_folder(self):
        self.assert_refused("core/vision/a.cpp", "", "no place in the architecture")

    def test_an_empty_tree_is_an_error_not_a_pass(self):
        with tempfile.TemporaryDirectory() as empty:
            self.assertEqual(check_includes.main(["check_includes.py", empty]), 1)


if __name__ == "__main__":
    unittest.main()
