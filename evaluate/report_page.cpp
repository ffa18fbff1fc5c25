#include "evaluate/report_page.h"

// The file's bytes, from evaluate/web/report_page.S.
extern "C" const char toile_report_page_begin[];
extern "C" const char toile_report_page_end[];

namespace toile::evaluate {

std::string_view report_page() {
    return {toile_report_page_begin, toile_report_page_end};
}

}  // namespace toile::evaluate
