#ifndef boneReportBundle_h
#define boneReportBundle_h

#include <string>

namespace bone
{
/** The report page's script: base64 of its gzip, without line breaks; empty where BoneTK was built without npm. */
std::string
ReportBundle();

/** The report page's style sheet (CSS). */
std::string
ReportStyle();

/** The short script that inflates and runs the bundle, which the page holds in the element `bonetk-bundle`. */
std::string
ReportLoader();
} // namespace bone

#endif
