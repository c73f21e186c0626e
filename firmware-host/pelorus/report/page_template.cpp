// The page as built from report/web, byte by byte in the program's read-only data. An array in C++ of a page this size
// would take the compiler many seconds; the assembler takes the file as it is.

#include <cstddef>

#include "firmware-host/pelorus/report/page.h"

__asm__(
    ".section .rodata\n"
    ".balign 16\n"
    "pelorus_report_page_begin:\n"
    ".incbin \"" PELORUS_REPORT_PAGE
    "\"\n"
    "pelorus_report_page_end:\n"
    ".byte 0\n"
    ".previous\n");

extern "C" {
extern const char pelorus_report_page_begin[];
extern const char pelorus_report_page_end[];
}

namespace pelorus {

std::string_view page_template() {
  return {pelorus_report_page_begin, static_cast<std::size_t>(pelorus_report_page_end - pelorus_report_page_begin)};
}

}  // namespace pelorus
