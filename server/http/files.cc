#include "server/http/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <stdexcept>
#include <system_error>

namespace server::http {
namespace {

constexpr std::uint64_t kPieceBytes = 256 * 1024;

[[noreturn]] void fail(const std::string& what) {
  throw std::system_error(errno, std::generic_category(), what);
}

}  // namespace

OpenFile::OpenFile(OpenFile&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}

OpenFile& OpenFile::operator=(OpenFile&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

OpenFile::~OpenFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

UploadFile::UploadFile(const std::filesystem::path& folder) {
  std::string name = (folder / "upload-XXXXXX").string();
  file_ = OpenFile(::mkostemp(name.data(), O_CLOEXEC));
  if (file_.descriptor() < 0) fail("cannot make a file in " + folder.string());
  path_ = name;
}

UploadFile::~UploadFile() {
  if (!path_.empty()) ::unlink(path_.c_str());
}

void UploadFile::write(const char* bytes, std::size_t size) {
  while (size > 0) {
    const ssize_t written = ::write(file_.descriptor(), bytes, size);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("cannot write to " + path_.string());
    bytes += written;
    size -= static_cast<std::size_t>(written);
  }
}

std::filesystem::path UploadFile::release() {
  file_ = OpenFile();
  return std::exchange(path_, {});
}

FileSource::FileSource(const FileBody& body) : file_(::open(body.path.c_str(), O_RDONLY | O_CLOEXEC)) {
  if (file_.descriptor() < 0) fail("cannot open " + body.path.string());
  struct stat status {};
  if (::fstat(file_.descriptor(), &status) != 0) fail("cannot ask for the size of " + body.path.string());
  size_ = left_ = static_cast<std::uint64_t>(status.st_size);
  if (body.remove_after) ::unlink(body.path.c_str());
}

bool FileSource::next(std::string& piece) {
  if (left_ == 0) return false;
  piece.resize(static_cast<std::size_t>(std::min(left_, kPieceBytes)));
  ssize_t got = 0;
  do {
    got = ::read(file_.descriptor(), piece.data(), piece.size());
  } while (got < 0 && errno == EINTR);
  if (got < 0) fail("cannot read a file that is being sent");
  if (got == 0) throw std::runtime_error("a file that is being sent has become shorter");
  piece.resize(static_cast<std::size_t>(got));
  left_ -= static_cast<std::uint64_t>(got);
  return true;
}

}  // namespace server::http
