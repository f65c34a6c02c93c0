// A Vulkan driver for Dawn: Mesa's lavapipe, with features that Dawn requires and that Debian 12's
// version lacks, namely dynamic indices of arrays of resources. No shader of WebGPU can use them. run.sh
// builds it. The environment variable LAVAPIPE may be the path of libvulkan_lvp.so.
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <vulkan/vulkan_core.h>

namespace {

VkInstance instance = nullptr; // Dawn has one at a time

void* library_function(const char* name) {
    static const char* const path = std::getenv("LAVAPIPE");
    static void* const library =
        dlopen(path != nullptr ? path : "libvulkan_lvp.so", RTLD_NOW | RTLD_LOCAL);
    return library != nullptr ? dlsym(library, name) : nullptr;
}

using Lookup = PFN_vkVoidFunction (*)(VkInstance, const char*);

template <class Function> Function lavapipe(const char* name) {
    static const auto look_up =
        reinterpret_cast<Lookup>(library_function("vk_icdGetInstanceProcAddr"));
    return look_up != nullptr ? reinterpret_cast<Function>(look_up(instance, name)) : nullptr;
}

void set_indexing(VkPhysicalDeviceFeatures& features, VkBool32 value) {
    features.shaderUniformBufferArrayDynamicIndexing = value;
    features.shaderSampledImageArrayDynamicIndexing = value;
    features.shaderStorageBufferArrayDynamicIndexing = value;
    features.shaderStorageImageArrayDynamicIndexing = value;
}

VKAPI_ATTR void VKAPI_CALL get_features(VkPhysicalDevice device,
                                        VkPhysicalDeviceFeatures* features) {
    lavapipe<PFN_vkGetPhysicalDeviceFeatures>("vkGetPhysicalDeviceFeatures")(device, features);
    set_indexing(*features, VK_TRUE);
}

VKAPI_ATTR void VKAPI_CALL get_features2(VkPhysicalDevice device,
                                         VkPhysicalDeviceFeatures2* features) {
    lavapipe<PFN_vkGetPhysicalDeviceFeatures2>("vkGetPhysicalDeviceFeatures2")(device, features);
    set_indexing(features->features, VK_TRUE);
}

// lavapipe refuses a device with features that it does not have. Dawn does not read them afterwards.
VKAPI_ATTR VkResult VKAPI_CALL create_device(VkPhysicalDevice device,
                                             const VkDeviceCreateInfo* info,
                                             const VkAllocationCallbacks* allocator,
                                             VkDevice* made) {
    if (info->pEnabledFeatures != nullptr)
        set_indexing(const_cast<VkPhysicalDeviceFeatures&>(*info->pEnabledFeatures), VK_FALSE);
    for (auto* more = static_cast<const VkBaseInStructure*>(info->pNext); more != nullptr;
         more = more->pNext)
        if (more->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2)
            set_indexing(
                reinterpret_cast<VkPhysicalDeviceFeatures2*>(const_cast<VkBaseInStructure*>(more))
                    ->features,
                VK_FALSE);
    return lavapipe<PFN_vkCreateDevice>("vkCreateDevice")(device, info, allocator, made);
}

VKAPI_ATTR VkResult VKAPI_CALL create_instance(const VkInstanceCreateInfo* info,
                                               const VkAllocationCallbacks* allocator,
                                               VkInstance* made) {
    const VkResult result =
        lavapipe<PFN_vkCreateInstance>("vkCreateInstance")(info, allocator, made);
    if (result == VK_SUCCESS)
        instance = *made;
    return result;
}

// Our function of this name; nullptr: lavapipe's is used.
PFN_vkVoidFunction own_function(const char* name) {
    const auto is = [&](const char* other) { return std::strcmp(name, other) == 0; };
    if (is("vkGetPhysicalDeviceFeatures"))
        return reinterpret_cast<PFN_vkVoidFunction>(get_features);
    if (is("vkGetPhysicalDeviceFeatures2") || is("vkGetPhysicalDeviceFeatures2KHR"))
        return reinterpret_cast<PFN_vkVoidFunction>(get_features2);
    if (is("vkCreateDevice"))
        return reinterpret_cast<PFN_vkVoidFunction>(create_device);
    if (is("vkCreateInstance"))
        return reinterpret_cast<PFN_vkVoidFunction>(create_instance);
    return nullptr;
}

PFN_vkVoidFunction function_by(const char* lookup, VkInstance of, const char* name) {
    if (const PFN_vkVoidFunction own = own_function(name))
        return own;
    const auto look_up = reinterpret_cast<Lookup>(library_function(lookup));
    return look_up != nullptr ? look_up(of, name) : nullptr;
}

} // namespace

// What the loader calls.
extern "C" {

VKAPI_ATTR VkResult VKAPI_CALL vk_icdNegotiateLoaderICDInterfaceVersion(std::uint32_t* version) {
    using Negotiate = VkResult (*)(std::uint32_t*);
    const auto negotiate =
        reinterpret_cast<Negotiate>(library_function("vk_icdNegotiateLoaderICDInterfaceVersion"));
    return negotiate != nullptr ? negotiate(version) : VK_ERROR_INITIALIZATION_FAILED;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL vk_icdGetPhysicalDeviceProcAddr(VkInstance of,
                                                                         const char* name) {
    return function_by("vk_icdGetPhysicalDeviceProcAddr", of, name);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL vk_icdGetInstanceProcAddr(VkInstance of,
                                                                   const char* name) {
    return function_by("vk_icdGetInstanceProcAddr", of, name);
}

} // extern "C"
