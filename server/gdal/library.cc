#include "server/gdal/library.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_http.h>
#include <gdal_frmts.h>
#include <gdal_priv.h>
#include <ogr_srs_api.h>
#include <ogrsf_frmts.h>

#include <array>
#include <mutex>

namespace server::gdal {
namespace {

constexpr std::array<const char*, 10> kRasterDrivers{"GTiff", "SRTMHGT", "AAIGrid", "USGSDEM", "DTED",
                                                     "GSAG",  "GSBG",    "GS7BG",   "BT",      nullptr};
constexpr std::array<const char*, 5> kVectorDrivers{"GeoJSON", "GPKG", "FlatGeobuf", "ESRI Shapefile",
                                                    nullptr};
/// Can only write.
constexpr const char* kCogDriver = "COG";
constexpr GIntBig kBlockCacheBytes = GIntBig{64} << 20;

/// A GeoJSON file may name its CRS by a link, and GDAL would follow it. (Without a result it would go on and
/// ask.)
CPLHTTPResult* refuse_request(const char*, CSLConstList, GDALProgressFunc, void*, CPLHTTPFetchWriteFunc,
                              void*, void*) {
  constexpr const char* kRefusal = "Links are not followed";
  CPLError(CE_Failure, CPLE_AppDefined, "%s", kRefusal);
  auto* result = static_cast<CPLHTTPResult*>(CPLCalloc(1, sizeof(CPLHTTPResult)));
  result->nStatus = 1;
  result->pszErrBuf = CPLStrdup(kRefusal);
  return result;
}

void configure() {
  CPLSetErrorHandler(CPLQuietErrorHandler);
  CPLSetConfigOption("GDAL_DISABLE_READDIR_ON_OPEN", "EMPTY_DIR");
  CPLSetConfigOption("GDAL_PAM_ENABLED", "NO");
  CPLSetConfigOption("OGR_SQLITE_ALLOW_EXTERNAL_ACCESS", "NO");
  CPLHTTPSetFetchCallback(refuse_request, nullptr);
  OSRSetPROJEnableNetwork(FALSE);
  GDALSetCacheMax64(kBlockCacheBytes);

  GDALRegister_GTiff();
  GDALRegister_SRTMHGT();
  GDALRegister_AAIGrid();
  GDALRegister_USGSDEM();
  GDALRegister_DTED();
  GDALRegister_GSAG();
  GDALRegister_GSBG();
  GDALRegister_GS7BG();
  GDALRegister_BT();
  GDALRegister_COG();
  RegisterOGRGeoJSON();
  RegisterOGRGeoPackage();
  RegisterOGRFlatGeobuf();
  RegisterOGRShape();
  // A driver may bring others along; keep only what the lists name.
  GDALDriverManager* manager = GetGDALDriverManager();
  for (int i = manager->GetDriverCount() - 1; i >= 0; --i) {
    GDALDriver* driver = manager->GetDriver(i);
    bool allowed = EQUAL(kCogDriver, driver->GetDescription());
    for (const char* name : raster_drivers()) allowed = allowed || EQUAL(name, driver->GetDescription());
    for (const char* name : vector_drivers()) allowed = allowed || EQUAL(name, driver->GetDescription());
    if (!allowed) manager->DeregisterDriver(driver);
  }
}

void collect(CPLErr severity, CPLErrorNum, const char* message) {
  if (severity >= CE_Failure) static_cast<Complaints*>(CPLGetErrorHandlerUserData())->add(message);
}

}  // namespace

void prepare_library() {
  static std::once_flag once;
  std::call_once(once, configure);
}

std::span<const char* const> raster_drivers() {
  return {kRasterDrivers.data(), kRasterDrivers.size() - 1};
}
std::span<const char* const> vector_drivers() {
  return {kVectorDrivers.data(), kVectorDrivers.size() - 1};
}

Complaints::Complaints() {
  CPLPushErrorHandlerEx(collect, this);
}
Complaints::~Complaints() {
  CPLPopErrorHandler();
}

void Complaints::add(const char* message) {
  if (first_.empty()) first_ = message;
}

std::string Complaints::aside(const std::string& private_folder) const {
  if (first_.empty()) return {};
  std::string text = first_.substr(0, 300);
  if (!private_folder.empty()) {
    for (std::size_t at; (at = text.find(private_folder + "/")) != std::string::npos;) {
      text.erase(at, private_folder.size() + 1);
    }
  }
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) >= 0x7f) c = ' ';
  }
  return " (GDAL: " + text + ")";
}

}  // namespace server::gdal
